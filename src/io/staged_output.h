#pragma once

#include <filesystem>
#include <memory>

#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

/// Files that appear in a folder all together: they are written into a folder within it, in folders of their own as
/// they need, and moved by commit(). Without commit() the target stays as it was and nothing is left behind; what a
/// process that was killed left behind goes when the target is next written.
class SAW_NDT_EXPORT StagedOutput {
 public:
  /// @param target  a folder that exists
  /// @throws Error where nothing can be written into it
  explicit StagedOutput(const std::filesystem::path& target);
  ~StagedOutput();
  StagedOutput(const StagedOutput&) = delete;
  StagedOutput& operator=(const StagedOutput&) = delete;

  /// Where to write.
  const std::filesystem::path& folder() const;

  /// Moves every file to the same place below the target; files there of other names stay, those that are replaced
  /// leave their owner and mode. To be called once.
  /// @throws Error before anything is moved where a folder has the name of a file to come, or a file that of a folder
  void commit();

 private:
  class Staging;

  std::filesystem::path target_;
  std::unique_ptr<Staging> staging_;
};

}  // namespace saw_ndt::internal
