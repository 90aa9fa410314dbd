#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "map/ndt_level.h"

namespace saw_ndt {

/// What a map was made of and how its sums are to be read.
struct MapOrigin {
  double resolution_m = 1.0;
  bool labelled = false;          ///< whether the points carried structural labels
  std::uint64_t scan_count = 0;   ///< clouds added
  std::uint64_t point_count = 0;  ///< finite points added, over all labels
};

/// The weighted NDT map of the paper (Section III.B): for every voxel its index, mean, covariance, mean confidence,
/// structure class, point count and weight, on a fine level and on a coarser one whose voxels add up the fine ones.
/// It keeps the exact integer sums that these follow from, so that maps can be merged, saved without loss, and read
/// again with other confidences. A value: immutable once made, and safe to read from many threads.
class WeightedVoxelMap {
 public:
  WeightedVoxelMap() = default;
  /// @param entries  each voxel and label at most once, in any order
  /// @param threads  0: all cores; the map does not depend on it
  /// @throws std::invalid_argument for options that do not hold, or an entry given twice
  WeightedVoxelMap(const MapOrigin& origin, std::vector<LabelledVoxelSums> entries,
                   const VoxelWeighting& weighting = {}, int threads = 1);

  const MapOrigin& origin() const { return origin_; }
  /// Edge of a fine voxel (m).
  double resolution() const { return origin_.resolution_m; }
  /// Whether its points carried labels; without them there are no weights, and matching is classical NDT.
  bool labelled() const { return origin_.labelled; }
  const VoxelWeighting& weighting() const { return weighting_; }

  /// The voxels that have a distribution.
  const NdtLevel& fine() const { return fine_; }
  /// The same at coarse_factor times the edge; empty where coarse_factor is 1.
  const NdtLevel& coarse() const { return coarse_; }
  /// Whether there is nothing to match against.
  bool empty() const { return fine_.empty(); }

  /// The exact sums, ordered by tile, voxel (z, y, x) and label.
  const std::vector<LabelledVoxelSums>& entries() const { return entries_; }

  /// The same points read with other confidences and weights.
  WeightedVoxelMap reweighted(const VoxelWeighting& weighting, int threads = 1) const {
    return {origin_, entries_, weighting, threads};
  }

  /// Writes the map file (see map_file.h). @throws Error
  void save(const std::string& path) const;
  /// Reads a map file. @throws Error where it is missing, damaged, truncated or foreign
  static WeightedVoxelMap load(const std::string& path, const VoxelWeighting& weighting = {}, int threads = 1);

 private:
  MapOrigin origin_;
  VoxelWeighting weighting_;
  std::vector<LabelledVoxelSums> entries_;
  NdtLevel fine_;
  NdtLevel coarse_;
};

}  // namespace saw_ndt
