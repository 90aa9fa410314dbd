#pragma once

#include <filesystem>
#include <memory>
#include <ostream>

#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

/// A file that appears under its name only when it is whole: it is written beside the target and renamed by commit().
/// Without commit() the target stays as it was and nothing is left behind; what a process that was killed left behind
/// goes when the target is next written. A target that is replaced leaves its mode and, where the system allows that,
/// its owner to the new file.
class SAW_NDT_EXPORT AtomicOutput {
 public:
  /// Opens the temporary file. Throws Error, naming the target and the system's reason, where the folder is missing or
  /// not writable, or where the target exists and is no regular file. A symbolic link keeps pointing at the new file.
  explicit AtomicOutput(const std::filesystem::path& target);
  ~AtomicOutput();
  AtomicOutput(const AtomicOutput&) = delete;
  AtomicOutput& operator=(const AtomicOutput&) = delete;

  /// Binary, in the classic locale whatever the global one is. It can be put to a place from the beginning.
  std::ostream& stream();

  /// The temporary file, which other processes may write parts of until commit().
  const std::filesystem::path& temporary() const;

  /// Flushes, checks that everything was written and renames: where there was a file before, once the new one is on the
  /// disk. Throws Error with the system's reason, such as a full disk; to be called once.
  void commit();

 private:
  class Temporary;

  std::filesystem::path target_;
  std::filesystem::path resolved_target_;
  std::unique_ptr<Temporary> temporary_;
  std::ostream stream_;
};

}  // namespace saw_ndt::internal
