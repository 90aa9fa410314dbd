#pragma once

#include <filesystem>
#include <string>

namespace saw_ndt {

/// A folder for an app's results. It is made, and found writable, before the work begins; if the work then fails, what
/// was made here goes away again, folders above it included.
class OutputFolder {
 public:
  /// @throws Error that names the folder and the reason
  explicit OutputFolder(const std::string& path);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// The results are complete: the folder stays.
  void keep() { kept_ = true; }

 private:
  std::filesystem::path path_;
  std::filesystem::path topmost_made_;  // empty: nothing was made
  bool kept_ = false;
};

}  // namespace saw_ndt
