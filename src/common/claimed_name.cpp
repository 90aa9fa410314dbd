#include "common/claimed_name.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

namespace saw_ndt::internal {

namespace fs = std::filesystem;

namespace {

constexpr int kMostNames = 10000;
constexpr int kNamesLookedAt = 4;  // behind the one that is taken, where others may have been left behind

fs::path numbered(const fs::path& stem, int number) {
  fs::path path = stem;
  path += "-" + std::to_string(number);
  return path;
}

int openExisting(const fs::path& path, bool folder) {
  const int flags = folder ? O_RDONLY | O_DIRECTORY : O_RDWR | O_NONBLOCK;
  return open(path.c_str(), flags | O_NOFOLLOW | O_CLOEXEC);
}

/// Whether a name is that of an open file or folder.
bool isNamed(const fs::path& path, int descriptor) {
  struct stat named {
  }, opened{};
  return lstat(path.c_str(), &named) == 0 && fstat(descriptor, &opened) == 0 && named.st_dev == opened.st_dev &&
         named.st_ino == opened.st_ino;
}

/// Removes what was left behind. What is removed is locked, so that nobody else takes it or makes another one of that
/// name meanwhile.
void removeAbandoned(const fs::path& path, bool folder) {
  const int descriptor = openExisting(path, folder);
  if (descriptor < 0) return;
  struct stat status {};
  const bool of_kind = fstat(descriptor, &status) == 0 && (folder || S_ISREG(status.st_mode));
  std::error_code ignored;
  if (of_kind && flock(descriptor, LOCK_EX | LOCK_NB) == 0 && isNamed(path, descriptor)) fs::remove_all(path, ignored);
  close(descriptor);
}

/// The descriptor of a new file or folder; less than 0 where that failed.
int make(const fs::path& path, bool folder, unsigned mode) {
  if (!folder) return open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, mode);
  return mkdir(path.c_str(), mode) == 0 ? openExisting(path, true) : -1;
}

}  // namespace

ClaimedName ClaimedName::claim(const fs::path& stem, bool folder, unsigned mode) {
  for (int number = 0; number < kMostNames; ++number) {
    ClaimedName name(numbered(stem, number), -1);
    removeAbandoned(name.path_, folder);
    name.descriptor_ = make(name.path_, folder, mode);
    if (name.descriptor_ < 0 && errno == EEXIST) continue;
    if (name.descriptor_ < 0) throw std::system_error(errno, std::generic_category());
    // Another process may take it for one that was left behind, before it is locked.
    if (flock(name.descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) continue;
    if (!isNamed(name.path_, name.descriptor_)) continue;
    for (int i = 1; i <= kNamesLookedAt; ++i) removeAbandoned(numbered(stem, number + i), folder);
    return name;
  }
  throw std::system_error(EEXIST, std::generic_category());
}

ClaimedName ClaimedName::ofFile(const fs::path& stem, unsigned mode) { return claim(stem, false, mode); }
ClaimedName ClaimedName::ofFolder(const fs::path& stem) { return claim(stem, true, 0700); }

ClaimedName::ClaimedName(ClaimedName&& other) noexcept
    : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

ClaimedName::~ClaimedName() {
  if (descriptor_ >= 0) close(descriptor_);
}

}  // namespace saw_ndt::internal
