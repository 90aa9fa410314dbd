#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "saw_ndt/map/weighted_voxel_map.h"

namespace saw_ndt {

/// Mean and extremes of a figure over the voxels of a map; 0 where there is none.
struct VoxelFigure {
  double mean = 0.0;
  double min = 0.0;
  double max = 0.0;
};

/// What a map holds.
struct MapSummary {
  double resolution_m = 0.0;         ///< edge of a fine voxel
  double coarse_resolution_m = 0.0;  ///< edge of a coarse voxel, 0 without a coarse level
  bool labelled = false;
  Eigen::Vector3d map_origin_m = Eigen::Vector3d::Zero();  ///< see MapOrigin
  std::uint64_t dead_bytes = 0;  ///< that updates left in the map's file; summarize() does not know it
  std::string software_version;  ///< that added the points; empty where it is not known
  std::optional<SegmentationOptions> segmentation;  ///< how labels were made; nothing without labels or not known
  std::uint64_t scans = 0;
  std::uint64_t points = 0;
  std::size_t entries = 0;                              ///< sums kept: one a voxel and label that occurs in it
  std::size_t voxels = 0;                               ///< fine voxels with a distribution
  std::size_t coarse_voxels = 0;                        ///< coarse voxels with a distribution
  Eigen::Vector3d box_min_m = Eigen::Vector3d::Zero();  ///< lower corner of the voxels that hold points, map frame
  Eigen::Vector3d box_max_m = Eigen::Vector3d::Zero();  ///< upper corner of them
  std::array<std::uint64_t, 3> label_points{};          ///< points by StructuralLabel; all non-ground if not labelled
  std::array<std::size_t, 3> class_voxels{};            ///< fine voxels: linear, planar, volumetric
  VoxelFigure mean_confidence;                          ///< over the fine voxels
  VoxelFigure weight;                                   ///< over the fine voxels
};

/// @param weighting  by which voxels get their confidences and weights, and which have a distribution at all
MapSummary summarize(const WeightedVoxelMap& map, const VoxelWeighting& weighting = {});

/// A line a figure: its name in toJsonText(), then its value. What a file does not tell is "not known" in both.
std::string toText(const MapSummary& summary);
/// One JSON object, indented, with a line end. Shares lie in [0, 1] and are 0 where there is nothing to share.
std::string toJsonText(const MapSummary& summary);

}  // namespace saw_ndt
