#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/register_point_struct.h>

#include <cstdint>
#include <string>

#include "report/gnuplot.h"
#include "saw_ndt/map/map_diff.h"

namespace saw_ndt {

/// A line a figure: its name in toJsonText(), then its value; after them the largest groups, a line each.
std::string toText(const MapDiff& diff);
/// One JSON object, indented, with a line end: options, counts of both maps, gaps of flat voxels and all groups.
std::string toJsonText(const MapDiff& diff);

/// A changed voxel as a point to look at: its mean (m, map frame). `change` and `map` are floats because pcl_viewer
/// reads every field but `label` as one.
struct EIGEN_ALIGN16 ChangedPoint {
  PCL_ADD_POINT4D;
  std::uint32_t label = 0;    ///< the StructuralLabel that most of its points carry
  float change = 0.0F;        ///< 1 appeared, 2 vanished, 3 moved
  float map = 0.0F;           ///< 1 or 2: the map that has it
  float displacement = 0.0F;  ///< m, of moved voxels
  PCL_MAKE_ALIGNED_OPERATOR_NEW
};

/// The changed voxels in the order of MapDiff::changes. Coordinates are single precision, as those of voxelCloud().
pcl::PointCloud<ChangedPoint> changedCloud(const MapDiff& diff);

/// The changed voxels from above, on all voxels of both maps in grey; groups that are small in the picture are circled,
/// the largest hundred of a kind.
GnuplotPicture mapDiffPicture(const MapDiff& diff, const WeightedVoxelMap& first, const WeightedVoxelMap& second);

}  // namespace saw_ndt

POINT_CLOUD_REGISTER_POINT_STRUCT(saw_ndt::ChangedPoint,
                                  (float, x, x)(float, y, y)(float, z, z)(std::uint32_t, label, label)(
                                      float, change, change)(float, map, map)(float, displacement, displacement))
