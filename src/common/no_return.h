#pragma once

namespace saw_ndt::internal {

/// Whether a point of a scan is one: drivers write the origin for "no return".
/// @param xyz  its coordinates in the frame of the LiDAR
inline bool isReturn(const float* xyz) { return xyz[0] != 0.0F || xyz[1] != 0.0F || xyz[2] != 0.0F; }

}  // namespace saw_ndt::internal
