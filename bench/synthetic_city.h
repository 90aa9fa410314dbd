#pragma once

#include <cstddef>

#include "saw_ndt/map/ndt_target.h"
#include "saw_ndt/registration/source_points.h"

namespace saw_ndt {

// A city of any size for the benchmarks: level ground, and walls every 40 m along x and y. All voxels are 1 m wide.

/// The map of the `voxel_count` voxels that are nearest to the middle: the whole city block there from about 3000 on,
/// of which a larger map has the same voxels.
NdtTarget cityTarget(std::size_t voxel_count);

/// What a LiDAR of 64 rings sees in the block in the middle, `point_count` points in the order of its rings (m, map
/// frame), labelled.
SourcePoints cityScan(std::size_t point_count);

/// `point_count` points of the ground voxel in the middle (m, map frame), labelled: all that they pair with is in the
/// nearest 9 voxels.
SourcePoints cityPatch(std::size_t point_count);

}  // namespace saw_ndt
