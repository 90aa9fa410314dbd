#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

#include "saw_ndt/common/export.h"

namespace saw_ndt {

/// Reads the vertices of a polygon, x and y (m) of one a line, apart by blanks or, in CSV, by commas; the last one may
/// repeat the first. Lines that are blank or start with '#' are skipped. CSV may begin with a line of names, in which
/// capitals do not matter: then the columns `x` and `y`, or `x_m` and `y_m`, are read and others are not.
/// @throws Error that names the line of what is no such vertex, and where there are fewer than three
SAW_NDT_EXPORT std::vector<Eigen::Vector2d> readPolygon(const std::filesystem::path& path);

}  // namespace saw_ndt
