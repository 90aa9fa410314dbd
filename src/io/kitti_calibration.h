#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

namespace saw_ndt::internal {

/// The line of a KITTI calibration file whose key is one of these, a rigid transform of 12 numbers row by row. Colons
/// and blanks before the numbers may be there or not. Nothing where there is no such line. Throws Error that names the
/// line.
std::optional<Eigen::Isometry3d> kittiTransform(const std::filesystem::path& path,
                                                const std::vector<std::string_view>& keys);

/// The same of a rotation of 9 numbers.
std::optional<Eigen::Isometry3d> kittiRotation(const std::filesystem::path& path,
                                               const std::vector<std::string_view>& keys);

}  // namespace saw_ndt::internal
