#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "map/voxel_index.h"
#include "saw_ndt/drives/drive_map.h"
#include "saw_ndt/drives/kitti_sequence.h"
#include "saw_ndt/map/weighted_voxel_map.h"

namespace saw_ndt {

/// What a point was measured on, by its class of SemanticKITTI: UNLABELLED are classes 0 and 1, such as droplets.
enum class PointKind { MOVING, PARKED, GROUND, FACADE, BARRIER, VEGETATION, POLE, OTHER, UNLABELLED };
constexpr std::size_t kPointKinds = 9;
/// "moving" and so on, in their order.
const std::array<const char*, kPointKinds>& pointKindNames();

/// How many points there are of each kind.
using PointCounts = std::array<std::uint64_t, kPointKinds>;

/// What has been removed from a map.
struct RemovalScore {
  PointCounts points{};            ///< of the map
  PointCounts removed{};           ///< of them
  std::size_t moving_voxels = 0;   ///< with points not labelled ground, most of them of what moves
  std::size_t removed_voxels = 0;  ///< whatever they hold
  std::size_t removed_moving_voxels = 0;

  /// Share of the points of a kind that were removed, 0 where there is none.
  double removedShare(PointKind kind) const;
  /// Share of all points of what does not move that were removed; those without a class are not counted.
  double removedStaticShare() const;
  /// Share of the removed points that are of what moves, of those with a class.
  double precision() const;
};

/// What the points of a map were measured on, by the labels of its drive.
class MovingTruth {
 public:
  /// @param map  of these scans, by these options
  /// @throws Error where a scan or its labels cannot be read
  MovingTruth(const KittiSequence& sequence, const std::vector<int>& scans, const DriveMapOptions& options,
              const WeightedVoxelMap& map);

  /// @param remaining  the map without some of its entries
  RemovalScore score(const WeightedVoxelMap& map, const WeightedVoxelMap& remaining) const;

 private:
  using OfLabels = std::array<PointCounts, kStructuralLabelCount>;

  internal::VoxelIndex index_;
  std::vector<OfLabels> counts_;
};

}  // namespace saw_ndt
