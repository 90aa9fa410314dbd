#pragma once

#include <filesystem>
#include <memory>
#include <ostream>

#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

/// A file that appears under its name only when it is whole: it is written beside the target and renamed by commit().
/// Without commit() the target stays as it was and nothing is left behind.
class SAW_NDT_EXPORT AtomicOutput {
 public:
  /// Opens the temporary file. Throws Error, naming the target and the system's reason, where the folder is missing or
  /// not writable, or where the target exists and is no regular file. A symbolic link keeps pointing at the new file.
  explicit AtomicOutput(const std::filesystem::path& target);
  ~AtomicOutput();
  AtomicOutput(const AtomicOutput&) = delete;
  AtomicOutput& operator=(const AtomicOutput&) = delete;

  /// Binary, seekable, in the classic locale whatever the global one is.
  std::ostream& stream();

  /// The temporary file, which other processes may write parts of until commit().
  const std::filesystem::path& temporary() const { return temporary_; }

  /// Flushes, checks that everything was written and renames. Throws Error with the system's reason, such as a full
  /// disk; to be called once.
  void commit();

 private:
  class FileBuffer;

  std::filesystem::path target_;
  std::filesystem::path resolved_target_;
  std::filesystem::path temporary_;
  std::unique_ptr<FileBuffer> buffer_;
  std::ostream stream_;
};

}  // namespace saw_ndt::internal
