#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "common/unfinished_output.h"

namespace saw_ndt {

/// A folder for an app's results. It is made, and found writable, before the work begins; if the work then fails, or a
/// signal ends it, what was made here goes away again, folders above it included.
class OutputFolder {
 public:
  /// @throws Error that names the folder and the reason
  explicit OutputFolder(const std::string& path);
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// The results are complete: the folder stays.
  void keep() { made_->finish(); }

 private:
  std::filesystem::path path_;
  std::optional<internal::UnfinishedOutput> made_;  // the topmost folder that was; of no path: none
};

}  // namespace saw_ndt
