#pragma once

#include <cstdint>

#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

/// Writes all of some bytes at a place of a file, however often the system has to be asked.
/// @return false where it could not be done; errno tells why
SAW_NDT_EXPORT bool writeAt(int descriptor, std::uint64_t offset, const void* bytes, std::uint64_t count);

}  // namespace saw_ndt::internal
