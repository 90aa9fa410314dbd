#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "map/voxel_index.h"
#include "saw_ndt/map/voxel_statistics.h"

namespace saw_ndt {

/// What matching reads of a voxel.
struct NdtCell {
  double mean_from_centre[3];    ///< m
  double inverse_covariance[6];  ///< 1/m^2: xx xy xz yy yz zz
  double weight;                 ///< w_target of the paper
  double mean_confidence;
};

/// The same in single precision, in a cache line of its own.
struct alignas(64) PackedNdtCell {
  explicit PackedNdtCell(const NdtCell& cell);

  float mean_from_centre[3];    ///< m
  float inverse_covariance[6];  ///< 1/m^2: xx xy xz yy yz zz
  float weight;                 ///< w_target of the paper
  float mean_confidence;
};

/// The voxels of one resolution that have a distribution, in flat arrays.
class NdtLevel {
 public:
  NdtLevel() = default;
  NdtLevel(double resolution_m, const std::vector<VoxelStatistics>& voxels);

  /// Groups labelled sums into voxels of `factor` times their size and makes the distribution of each. Sums whose label
  /// has confidence 0 take no part. `entries` hold the entries of a voxel one after the other.
  /// @param resolution_m  edge of the voxels of `entries`
  /// @param threads       0: all cores; the level does not depend on it
  static NdtLevel fromSums(const std::vector<LabelledVoxelSums>& entries, double resolution_m, int factor,
                           const VoxelWeighting& weighting, int threads = 1);

  /// Edge of a voxel (m).
  double resolution() const { return resolution_m_; }
  std::size_t size() const { return cells_.size(); }
  bool empty() const { return cells_.empty(); }

  const VoxelIndex& index() const { return index_; }
  const std::vector<NdtCell>& cells() const { return cells_; }
  const std::vector<PackedNdtCell>& packedCells() const { return packed_cells_; }

  /// Everything about voxel `i`, 0 <= i < size().
  VoxelStatistics voxel(std::size_t i) const;
  /// The number of the voxel that holds a position in the map frame (m), or VoxelIndex::kNone.
  std::int32_t find(const Eigen::Vector3d& position_m) const;

 private:
  double resolution_m_ = 1.0;
  std::vector<NdtCell> cells_;
  std::vector<PackedNdtCell> packed_cells_;
  std::vector<VoxelCoordinate> voxels_;
  std::vector<std::uint64_t> point_counts_;
  std::vector<StructureClass> structure_classes_;
  VoxelIndex index_;
};

}  // namespace saw_ndt
