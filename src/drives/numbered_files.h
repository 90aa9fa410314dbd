#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace saw_ndt::internal {

/// A file whose name is a number, but for its extension.
struct NumberedFile {
  unsigned long long number = 0;
  std::filesystem::path path;
};

/// Those of a folder that have an extension, by their numbers.
std::vector<NumberedFile> numberedFiles(const std::filesystem::path& folder, const std::string& extension);

}  // namespace saw_ndt::internal
