#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/map/weighted_voxel_map.h"

namespace saw_ndt {

/// What has become of a voxel between two maps of one place.
enum class VoxelChange : std::uint8_t {
  APPEARED = 1,  ///< the second map has it, the first one saw that nothing was there
  VANISHED = 2,  ///< the first map has it, the second one saw that nothing is there
  MOVED = 3,     ///< flat in both maps, displaced along its normal by one voxel at most
};
/// "appeared", "vanished" or "moved"
SAW_NDT_EXPORT std::string toString(VoxelChange change);

/// What counts as a change. By default halves of the scans of one drive have next to none.
struct SAW_NDT_EXPORT MapDiffOptions {
  int least_points = 10;              ///< of a voxel that is compared; 3 or more
  int least_scans = 3;                ///< that met such a voxel; not asked of a map of fewer scans
  double least_share_of_scans = 0.2;  ///< that met such a voxel, of those that met one in the columns around; 0 to 1
  double least_displacement_m = 0.1;  ///< along the normal, of a surface that has moved; positive
  int least_voxels = 4;               ///< of changes of one kind that touch each other; fewer are no change; 1 or more

  /// Throws std::invalid_argument that names the field and its value.
  void check() const;
};

/// A voxel that has changed.
struct ChangedVoxel {
  VoxelCoordinate voxel = VoxelCoordinate::Zero();
  VoxelChange change = VoxelChange::APPEARED;
  bool in_second = false;  ///< whether the second map has it or the first one, which matters for MOVED alone
  std::uint64_t point_count = 0;
  StructuralLabel label = StructuralLabel::NON_GROUND;       ///< that most of its points carry
  Eigen::Vector3d mean_m = Eigen::Vector3d::Zero();          ///< of its points, map frame
  Eigen::Vector3d displacement_m = Eigen::Vector3d::Zero();  ///< from the first map to the second; 0 unless MOVED
  std::size_t group = 0;                                     ///< place in MapDiff::groups
};

/// Voxels of one change that touch each other, by faces, edges or corners: a thing that came, went or was moved.
struct ChangedGroup {
  VoxelChange change = VoxelChange::APPEARED;
  std::size_t voxels = 0;
  Eigen::Vector3d least_m = Eigen::Vector3d::Zero();         ///< least corner of its voxels, map frame
  Eigen::Vector3d greatest_m = Eigen::Vector3d::Zero();      ///< greatest corner
  Eigen::Vector3d displacement_m = Eigen::Vector3d::Zero();  ///< mean of its voxels; 0 unless MOVED
};

/// How the voxels of one map fared; the numbers but the first one add up to `compared`.
struct MapDiffSide {
  std::size_t voxels = 0;       ///< with points
  std::size_t compared = 0;     ///< with enough points and scans
  std::size_t unchanged = 0;    ///< the other map has the same surface, or groups of changes are too small
  std::size_t changed = 0;      ///< vanished from the first map, appeared in the second
  std::size_t moved = 0;        ///< displaced
  std::size_t not_covered = 0;  ///< the other map has not seen the place

  bool operator==(const MapDiffSide& other) const {
    return voxels == other.voxels && compared == other.compared && unchanged == other.unchanged &&
           changed == other.changed && moved == other.moved && not_covered == other.not_covered;
  }
};

/// What has changed between two maps.
struct MapDiff {
  double resolution_m = 0.0;
  MapDiffOptions options;
  MapDiffSide first, second;
  std::vector<ChangedVoxel> changes;  ///< those of the first map, then those of the second, each in map order
  std::vector<ChangedGroup> groups;   ///< the largest first
  /// Percentiles 5, 50 and 95 of the distance of flat voxels that both maps have, from the first map to the second
  /// along the normal (m), the normal turned towards greater coordinates. Far from 0 where a map lies askew.
  std::array<double, 3> gap_percentiles_m{};
  std::size_t gap_count = 0;  ///< pairs of such voxels
};

/// Compares two maps of one place, voxel by voxel, whatever the labels of their points. docs/maps.md says by which
/// rules. The mirror image comes of the maps in the other order: appeared is vanished, displacements point back.
/// @param threads  0: all cores; the result does not depend on it
/// @throws std::invalid_argument where an option does not hold, or sizes of voxels or origins of the maps differ
SAW_NDT_EXPORT MapDiff diffMaps(const WeightedVoxelMap& first, const WeightedVoxelMap& second,
                                const MapDiffOptions& options = {}, int threads = 0);

}  // namespace saw_ndt
