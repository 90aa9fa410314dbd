#pragma once

#include <sys/stat.h>

#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

/// Gives a file that takes another one's place the owner and the mode of that one, as far as the system allows.
SAW_NDT_EXPORT void giveOwnerAndMode(const struct stat& replaced, int descriptor);

}  // namespace saw_ndt::internal
