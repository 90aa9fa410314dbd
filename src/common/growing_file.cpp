#include "common/growing_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "common/write_at.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

GrowingFile::GrowingFile(const std::string& path)
    : path_(path), descriptor_(open(path.c_str(), O_RDWR | O_CLOEXEC | O_NONBLOCK)) {
  if (descriptor_ < 0) fail();
  try {
    struct stat status {};
    if (fstat(descriptor_, &status) != 0) fail();
    if (!S_ISREG(status.st_mode)) throw Error(path_, "", "is no regular file");
    if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      if (errno == EWOULDBLOCK) throw Error(path_, "", "is being changed by another process");
      fail();
    }
    requireStillThere();
  } catch (...) {
    close(descriptor_);
    throw;
  }
}

GrowingFile::~GrowingFile() { close(descriptor_); }

void GrowingFile::fail() const { throw Error(path_, "", std::strerror(errno)); }

void GrowingFile::write(std::uint64_t offset, const void* bytes, std::uint64_t count) {
  if (!writeAt(descriptor_, offset, bytes, count)) fail();
}

void GrowingFile::resize(std::uint64_t size) {
  if (ftruncate(descriptor_, static_cast<off_t>(size)) != 0) fail();
}

void GrowingFile::sync() {
  if (fsync(descriptor_) != 0) fail();
}

void GrowingFile::requireStillThere() const {
  struct stat here {
  }, named{};
  if (fstat(descriptor_, &here) != 0 || stat(path_.c_str(), &named) != 0) fail();
  if (here.st_dev != named.st_dev || here.st_ino != named.st_ino) {
    throw Error(path_, "", "was replaced by another process");
  }
}

}  // namespace saw_ndt::internal
