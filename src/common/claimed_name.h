#pragma once

#include <filesystem>

#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

/// A new file or folder beside others, whose name is a stem and a number, and which its maker holds a lock on for as
/// long as it is open: what nobody holds was left behind by a process that was killed, and goes when the next one of
/// that stem is made. Where the file system has no locks, it stays.
class SAW_NDT_EXPORT ClaimedName {
 public:
  /// An empty file, open to be read and written. @param mode  of which the process's mask takes bits away
  static ClaimedName ofFile(const std::filesystem::path& stem, unsigned mode);
  static ClaimedName ofFolder(const std::filesystem::path& stem);  ///< an empty folder that is the user's alone
  // Both throw std::system_error.

  ~ClaimedName();
  ClaimedName(ClaimedName&& other) noexcept;
  ClaimedName& operator=(ClaimedName&&) = delete;

  const std::filesystem::path& path() const { return path_; }
  int descriptor() const { return descriptor_; }

 private:
  ClaimedName(std::filesystem::path path, int descriptor) : path_(std::move(path)), descriptor_(descriptor) {}
  static ClaimedName claim(const std::filesystem::path& stem, bool folder, unsigned mode);

  std::filesystem::path path_;
  int descriptor_;
};

}  // namespace saw_ndt::internal
