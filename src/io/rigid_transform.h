#pragma once

#include <Eigen/Geometry>
#include <array>
#include <filesystem>
#include <vector>

#include "saw_ndt/common/geometry.h"

namespace saw_ndt::internal {

/// The transform whose upper 3x4 matrix is given row by row, its rotation normalized. Throws Error, naming the line,
/// unless there are 12 numbers and the matrix is a rigid transform to within 1e-3.
Eigen::Isometry3d rigidTransform(const std::filesystem::path& path, std::size_t line,
                                 const std::vector<double>& values);

/// The pose that a stamp (s), a position (m) and a quaternion state: stamp, x, y, z, qx, qy, qz, qw. Throws Error,
/// naming the line, unless the quaternion's norm is 1 to within 1e-3.
StampedPose stampedPose(const std::filesystem::path& path, std::size_t line, const std::array<double, 8>& values);

}  // namespace saw_ndt::internal
