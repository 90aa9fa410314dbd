#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <vector>

namespace saw_ndt::internal {

/// The transform whose upper 3x4 matrix is given row by row, its rotation normalized. Throws Error, naming the line,
/// unless there are 12 numbers and the matrix is a rigid transform to within 1e-3.
Eigen::Isometry3d rigidTransform(const std::filesystem::path& path, std::size_t line,
                                 const std::vector<double>& values);

}  // namespace saw_ndt::internal
