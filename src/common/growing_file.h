#pragma once

#include <cstdint>
#include <string>

#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

/// An existing file that is changed in place, locked against others who open it so. Errors name the file and the
/// system's reason.
class SAW_NDT_EXPORT GrowingFile {
 public:
  /// @throws Error where the file is missing, no regular one or not writable, or another GrowingFile has it open, of
  /// this process or another one
  explicit GrowingFile(const std::string& path);
  ~GrowingFile();
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;

  void write(std::uint64_t offset, const void* bytes, std::uint64_t count);
  /// Makes the file end where it is to.
  void resize(std::uint64_t size);
  /// Returns once all that was written is on the disk.
  void sync();
  /// Throws Error where the name that was opened is no longer that of this file, which was replaced meanwhile.
  void requireStillThere() const;

 private:
  [[noreturn]] void fail() const;

  std::string path_;
  int descriptor_ = -1;
};

}  // namespace saw_ndt::internal
