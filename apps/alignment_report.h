#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "saw_ndt/registration/alignment.h"

namespace saw_ndt {

/// What saw_ndt_align tells of an alignment.
struct AlignmentReport {
  AlignmentResult result;
  bool weighted = false;  ///< by labels and structure; false: classical NDT
  std::size_t source_points = 0;
  std::size_t target_voxels = 0;
  std::optional<double> fitness_m2;  ///< mean squared distance to the nearest target point
};

/// The matrix in four lines, then a line a figure.
std::string toText(const AlignmentReport& report);
/// One JSON object, indented, with a line end.
std::string toJsonText(const AlignmentReport& report);

}  // namespace saw_ndt
