#pragma once

#include <vector>

#include "saw_ndt/registration/source_points.h"

namespace saw_ndt::internal {

/// A cell of a scan in which something stands.
struct OutlineCell {
  float x_m = 0.0F;  ///< from the base, along its axes
  float y_m = 0.0F;
  int layer = 0;  ///< height above the ground, as in PlaceIndex
};

/// What a scan is looked up by in a PlaceIndex.
struct ScanOutline {
  std::vector<OutlineCell> cells;
  double base_height_m = 0.0;  ///< of the base above the ground under it
};

/// Cells of 1 m that hold points which are not ground, at most `most_cells`: those 2 m and more above the ground, which
/// traffic does not reach, and lower ones only where these are few. Without labels the ground is what is lowest.
/// @param source  in the frame of the base, which is upright
ScanOutline outlineOf(const SourcePoints& source, std::size_t most_cells);

}  // namespace saw_ndt::internal
