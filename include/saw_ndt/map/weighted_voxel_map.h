#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/map/map_region.h"
#include "saw_ndt/map/voxel_statistics.h"
#include "saw_ndt/segmentation/segmentation_options.h"

namespace saw_ndt {

/// What a map was made of and how its sums are to be read.
struct SAW_NDT_EXPORT MapOrigin {
  double resolution_m = 1.0;
  bool labelled = false;          ///< whether the points carried structural labels
  std::uint64_t scan_count = 0;   ///< clouds added
  std::uint64_t point_count = 0;  ///< that have a voxel, over all labels
  /// How the labels were made; nothing where there are none or that is not known.
  std::optional<SegmentationOptions> segmentation;
  /// Version of this library that added the points, without line breaks; empty where it is not known.
  std::string software_version;
  /// Where the map frame's origin lies in the frame that the points were given in, such as UTM: a position there is one
  /// in the map plus this.
  Eigen::Vector3d map_origin_m = Eigen::Vector3d::Zero();

  /// Throws std::invalid_argument that names the field and its value.
  void check() const;
};

/// The store of a map: for every voxel and label the exact integer sums of its points. The distributions, classes and
/// weights of the paper (Section III.B) follow from them, so that maps can be merged, saved without loss and read with
/// any confidences. A value: immutable once made, and safe to read from many threads.
class SAW_NDT_EXPORT WeightedVoxelMap {
 public:
  WeightedVoxelMap() = default;
  /// @param entries  each voxel and label at most once, in any order
  /// @throws std::invalid_argument for an origin that does not hold, or an entry given twice
  WeightedVoxelMap(const MapOrigin& origin, std::vector<LabelledVoxelSums> entries);

  const MapOrigin& origin() const { return origin_; }
  /// Edge of a voxel (m).
  double resolution() const { return origin_.resolution_m; }
  /// Whether its points carried labels; without them there are no weights, and matching is classical NDT.
  bool labelled() const { return origin_.labelled; }
  /// The exact sums in map order: by tile of 64^3 voxels, then voxel, each by z, y and x, then label.
  const std::vector<LabelledVoxelSums>& entries() const { return entries_; }

  /// The statistics of every voxel of the map that has a distribution, in map order. Here and below the sizes of voxels
  /// that a weighting asks for, and unbounded ground, are those of targets: the map's own are told.
  /// @param threads  0: all cores; the result does not depend on it
  /// @throws std::invalid_argument where the weighting does not hold
  std::vector<VoxelStatistics> statistics(const VoxelWeighting& weighting = {}, int threads = 0) const;
  /// How many voxels have a distribution.
  std::size_t voxelCount(const VoxelWeighting& weighting = {}, int threads = 0) const;
  /// The statistics of the voxel that holds a position in the map frame (m); nothing where it has no distribution.
  std::optional<VoxelStatistics> find(const Eigen::Vector3d& position_m, const VoxelWeighting& weighting = {}) const;

  /// Writes the map file (see map_file.h). @throws Error
  void save(const std::string& path) const;
  /// Reads a map file. @throws Error where it is missing, damaged, truncated or foreign
  static WeightedVoxelMap load(const std::string& path);
  /// Reads the part of a map file that lies in a region, as cropMap() makes it of the whole, and of the file only the
  /// tiles that can meet it: memory and time do not grow with the rest of the map, but for its directory of 40 bytes a
  /// tile, which is checked. Damage elsewhere is not found.
  /// @param threads  0: all cores
  /// @throws Error where the file or what is read of it is missing, damaged, truncated or foreign
  static WeightedVoxelMap load(const std::string& path, const MapRegion& region, int threads = 0);

 private:
  MapOrigin origin_;
  std::vector<LabelledVoxelSums> entries_;
};

}  // namespace saw_ndt
