#pragma once

namespace saw_ndt::internal {

/// Whether voxels of a map may have such an edge (m): with others curvatures leave the range of single precision.
inline bool isResolution(double resolution_m) { return resolution_m >= 1e-9 && resolution_m <= 1e9; }

}  // namespace saw_ndt::internal
