#include "common/owner_and_mode.h"

#include <unistd.h>

namespace saw_ndt::internal {

void giveOwnerAndMode(const struct stat& replaced, int descriptor) {
  // The superuser alone may give a file away, and not every file system has modes.
  [[maybe_unused]] const int owner = fchown(descriptor, replaced.st_uid, replaced.st_gid);
  [[maybe_unused]] const int mode = fchmod(descriptor, replaced.st_mode & 0777U);
}

}  // namespace saw_ndt::internal
