#pragma once

#include <filesystem>

#include "io/pcd_cloud.h"

namespace saw_ndt::internal {

/// Whether the name of a file says that it is a PLY file.
inline bool isPly(const std::filesystem::path& path) { return path.extension() == ".ply"; }

/// Turns the bytes of every number around, for files of the other byte order; of fields of one value a point.
void reverseBytes(PcdCloud& cloud);

/// Reads the vertices of a PLY file (ASCII, or binary of either byte order) with all their numbers, as fields of the
/// properties' names; CloudCompare's `scalar_` before a name is taken off. Other elements are passed over. Throws Error
/// that names the line or the offset.
PcdCloud readPlyCloud(const std::filesystem::path& path);

}  // namespace saw_ndt::internal
