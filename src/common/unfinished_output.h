#pragma once

#include <filesystem>
#include <functional>

#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

/// A file or folder that is being written. It is removed, with all that is in it, unless it is finished: by the
/// destructor, or by a signal that ends the process where that asked for it (see program_signals.h).
class SAW_NDT_EXPORT UnfinishedOutput {
 public:
  /// @param make  makes it and returns its path, empty where there is nothing to remove; what it throws is thrown on.
  /// No signal ends the process meanwhile. It must not make or finish another one.
  explicit UnfinishedOutput(const std::function<std::filesystem::path()>& make);
  ~UnfinishedOutput();
  UnfinishedOutput(const UnfinishedOutput&) = delete;
  UnfinishedOutput& operator=(const UnfinishedOutput&) = delete;

  const std::filesystem::path& path() const { return path_; }

  /// From now on it stays. @param publish  what makes it public, such as renaming it; where that throws it is still
  /// unfinished. No signal ends the process meanwhile: all of it happens or nothing.
  void finish(const std::function<void()>& publish = [] {});

 private:
  std::filesystem::path path_;
};

/// Removes what is unfinished and ends the process by a signal.
[[noreturn]] SAW_NDT_EXPORT void endBySignal(int signal_number);

}  // namespace saw_ndt::internal
