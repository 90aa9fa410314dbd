#pragma once

#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

/// From now on, blocks of half a megabyte and more go back to the system when they are freed. GNU's allocator otherwise
/// keeps ever larger ones once some were freed, and memory that comes and goes, such as tiles of a map, falls to
/// pieces. For programs, not for libraries: it concerns all of the process. Nothing happens with another allocator.
SAW_NDT_EXPORT void returnLargeBlocks();

}  // namespace saw_ndt::internal
