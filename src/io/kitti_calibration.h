#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "io/number_lines.h"

namespace saw_ndt::internal {

/// The numbers of the last line of a KITTI calibration file whose key is one of these, and the number of that line; 0
/// where there is none. Colons and blanks before them may be there or not. Throws Error that names the line.
NumberLine kittiNumbers(const std::filesystem::path& path, const std::vector<std::string_view>& keys);

/// The line of a KITTI calibration file whose key is one of these, a rigid transform of 12 numbers row by row. Nothing
/// where there is no such line. Throws Error that names the line.
std::optional<Eigen::Isometry3d> kittiTransform(const std::filesystem::path& path,
                                                const std::vector<std::string_view>& keys);

/// The same of a rotation of 9 numbers.
std::optional<Eigen::Isometry3d> kittiRotation(const std::filesystem::path& path,
                                               const std::vector<std::string_view>& keys);

}  // namespace saw_ndt::internal
