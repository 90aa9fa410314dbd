#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/register_point_struct.h>

#include <cstdint>
#include <vector>

#include "saw_ndt/map/weighted_voxel_map.h"

namespace saw_ndt {

/// A voxel of a map as a point to look at: its mean (m, map frame), and what it is by colour. The structure class is a
/// float because pcl_viewer reads every field but `label` as one.
struct EIGEN_ALIGN16 VoxelPoint {
  PCL_ADD_POINT4D;
  std::uint32_t label = 0;       ///< the StructuralLabel most of its points carry, the greater one of two as frequent
  float structure_class = 0.0F;  ///< 1 linear, 2 planar, 3 volumetric
  float weight = 0.0F;           ///< w_target of the paper
  PCL_MAKE_ALIGNED_OPERATOR_NEW
};

/// For each of the voxels of map.statistics() the label that most of its points carry, the greater one of two as
/// frequent; labels of confidence 0 do not count.
std::vector<StructuralLabel> voxelLabels(const WeightedVoxelMap& map, const std::vector<VoxelStatistics>& voxels,
                                         const ConfidenceOptions& confidence);

/// The voxels that have a distribution with a weighting, in map order. Coordinates are single precision: far
/// from the map's origin they are rounded, to 0.25 m at 4,000 km.
pcl::PointCloud<VoxelPoint> voxelCloud(const WeightedVoxelMap& map, const VoxelWeighting& weighting = {});

}  // namespace saw_ndt

POINT_CLOUD_REGISTER_POINT_STRUCT(saw_ndt::VoxelPoint,
                                  (float, x, x)(float, y, y)(float, z, z)(std::uint32_t, label, label)(
                                      float, structure_class, structure_class)(float, weight, weight))
