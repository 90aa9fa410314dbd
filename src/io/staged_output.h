#pragma once

#include <filesystem>

#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

/// Files that appear in a folder all together: they are written into a folder within it, in folders of their own as
/// they need, and moved by commit(). Without commit() the target stays as it was and nothing is left behind.
class SAW_NDT_EXPORT StagedOutput {
 public:
  /// @param target  a folder that exists
  /// @throws Error where nothing can be written into it
  explicit StagedOutput(const std::filesystem::path& target);
  ~StagedOutput();
  StagedOutput(const StagedOutput&) = delete;
  StagedOutput& operator=(const StagedOutput&) = delete;

  /// Where to write.
  const std::filesystem::path& folder() const { return folder_; }

  /// Moves every file to the same place below the target; files there of other names stay. To be called once.
  /// @throws Error before anything is moved where a folder has the name of a file to come, or a file that of a folder
  void commit() const;

 private:
  std::filesystem::path target_, folder_;
};

}  // namespace saw_ndt::internal
