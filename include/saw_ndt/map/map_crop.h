#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/map/weighted_voxel_map.h"

namespace saw_ndt {

/// Tells of a position in the map frame (m) whether it belongs.
using MapRegion = std::function<bool(const Eigen::Vector3d& position_m)>;

/// The voxels of a map whose centres belong to a region, whole and with their sums unchanged; none where none belongs.
/// Parts of a map that share no voxel merge into its entries again. Of the origin, point_count is that of the points
/// kept; scan_count stays that of the map, for which scans left no points is not known.
SAW_NDT_EXPORT WeightedVoxelMap cropMap(const WeightedVoxelMap& map, const MapRegion& region);

/// Positions from a least corner to a greatest one. The least coordinates belong, the greatest do not, so that a
/// position belongs to one of two boxes side by side. Corners may be infinite.
/// @throws std::invalid_argument unless every coordinate of the least corner is below that of the greatest
SAW_NDT_EXPORT MapRegion boxRegion(const Eigen::Vector3d& least_m, const Eigen::Vector3d& greatest_m);

/// Positions above and below a polygon: those from which a line to the right crosses its edges an odd number of times.
/// Of polygons side by side each position belongs to one.
/// @param vertices_m  x and y of three or more, finite; the last one is joined to the first
/// @throws std::invalid_argument
SAW_NDT_EXPORT MapRegion polygonRegion(const std::vector<Eigen::Vector2d>& vertices_m);

/// Positions whose horizontal distance from a line through points, in their order, is at most `radius_m`.
/// @param points_m  x and y of one or more, finite
/// @throws std::invalid_argument
SAW_NDT_EXPORT MapRegion regionAround(const std::vector<Eigen::Vector2d>& points_m, double radius_m);

}  // namespace saw_ndt
