#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <memory>

#include "saw_ndt/common/export.h"
#include "saw_ndt/common/scan_view.h"
#include "saw_ndt/map/weighted_voxel_map.h"

namespace saw_ndt {

/// When a voxel of a map is said to hold what moved.
struct MovedVoxelOptions {
  /// A voxel goes where fewer than this share of the scans that saw it, that is hit it or saw through it, hit it.
  /// Greater than 0, at most 0.5.
  double max_hit_share = 0.3;
  /// How far a scan is trusted to see through (m). Greater than 0.
  double max_range_m = 60.0;

  /// Throws std::invalid_argument that names the field and its value.
  SAW_NDT_EXPORT void check() const;
};

/// Finds the voxels of a map that hold what moved: vehicles and persons that few of the scans hit which saw through or
/// onto their place. The scans that hit a voxel are counted by the map; those that saw through it are counted here, in
/// a second pass over the scans. A scan saw through a voxel where one of its rays meets the mean of the voxel's points
/// and ends clearly behind, and so do all rays around. Voxels beside those that go, go too where at least one scan in
/// ten saw through them. What is labelled ground stays.
///
/// What comes out depends neither on the order of scans nor on the threads that add them, which may do so at once; the
/// rest is not to be called meanwhile. docs/moving_objects.md has the method with its limits.
class SAW_NDT_EXPORT MovedVoxels {
 public:
  /// @throws std::invalid_argument for options that do not hold, and for a map that does not tell how many scans met
  /// its voxels, as those of older files
  explicit MovedVoxels(WeightedVoxelMap map, const MovedVoxelOptions& options = {});
  ~MovedVoxels();
  MovedVoxels(MovedVoxels&&) noexcept;
  MovedVoxels& operator=(MovedVoxels&&) noexcept;

  /// The map that was given.
  const WeightedVoxelMap& map() const;

  /// Counts what a scan saw through. Any number of threads may call it at once, each with another scan. Each scan of
  /// the map should be added once; scans that are not of the map may be added, too.
  /// @param T_map_scan  pose of the scan's frame, whose origin is the LiDAR, in the map frame
  /// @throws std::invalid_argument for a pose that is not finite
  void addScan(const ScanView& scan, const Eigen::Isometry3d& T_map_scan);

  /// The map without the points, not labelled ground, of the voxels that hold what moved. Of its origin, point_count is
  /// that of the points kept, as with cropMap().
  WeightedVoxelMap remaining() const;

 private:
  class Counts;
  std::unique_ptr<Counts> counts_;
};

}  // namespace saw_ndt
