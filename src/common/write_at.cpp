#include "common/write_at.h"

#include <unistd.h>

#include <cerrno>

namespace saw_ndt::internal {

bool writeAt(int descriptor, std::uint64_t offset, const void* bytes, std::uint64_t count) {
  const char* next = static_cast<const char*>(bytes);
  while (count > 0) {
    const ssize_t written = pwrite(descriptor, next, count, static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    next += written;
    offset += static_cast<std::uint64_t>(written);
    count -= static_cast<std::uint64_t>(written);
  }
  return true;
}

}  // namespace saw_ndt::internal
