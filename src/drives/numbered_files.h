#pragma once

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

namespace saw_ndt::internal {

/// A file whose name is a number, but for its extension.
struct NumberedFile {
  unsigned long long number = 0;
  std::filesystem::path path;
};

/// How many lines a file has that has one of this number, counted from 0. No file has as many as the greatest number.
inline unsigned long long linesUpTo(unsigned long long number) {
  return number == std::numeric_limits<unsigned long long>::max() ? number : number + 1;
}

/// Those of a folder that have an extension, by their numbers.
std::vector<NumberedFile> numberedFiles(const std::filesystem::path& folder, const std::string& extension);

}  // namespace saw_ndt::internal
