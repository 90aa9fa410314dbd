#pragma once

#include <boost/interprocess/mapped_region.hpp>
#include <cstddef>
#include <cstdint>
#include <string>

#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

/// A file mapped into memory to be read. Its pages are read when they are touched, and shared with other processes that
/// map it. A file that somebody cuts short meanwhile ends the process by SIGBUS when what is missing is read, which a
/// library cannot prevent (a program can have the file named, see program_signals.h); one that is replaced stays as it
/// was.
class SAW_NDT_EXPORT MappedFile {
 public:
  /// @throws Error with the system's reason where the file cannot be opened or mapped, or is none
  explicit MappedFile(const std::string& path);

  const char* data() const { return static_cast<const char*>(region_.get_address()); }
  std::size_t size() const { return region_.get_size(); }

  /// Gives back the memory of the pages that a range of the file meets, which will hardly be read again: the process
  /// has less of it, and what is read is the same.
  void forget(std::uint64_t offset, std::uint64_t count) const;

 private:
  boost::interprocess::mapped_region region_;  // of no size for an empty file
};

}  // namespace saw_ndt::internal
