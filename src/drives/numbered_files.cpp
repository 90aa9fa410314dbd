#include "drives/numbered_files.h"

#include <algorithm>
#include <charconv>

namespace saw_ndt::internal {

std::vector<NumberedFile> numberedFiles(const std::filesystem::path& folder, const std::string& extension) {
  std::vector<NumberedFile> files;
  for (const std::filesystem::directory_entry& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != extension) continue;
    NumberedFile file{0, entry.path()};
    const std::string stem = entry.path().stem().string();
    const auto [end, error] = std::from_chars(stem.data(), stem.data() + stem.size(), file.number);
    if (error == std::errc() && end == stem.data() + stem.size()) files.push_back(file);
  }
  std::sort(files.begin(), files.end(),
            [](const NumberedFile& a, const NumberedFile& b) { return a.number < b.number; });
  return files;
}

}  // namespace saw_ndt::internal
