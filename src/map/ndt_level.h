#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "map/level_plan.h"
#include "map/voxel_index.h"
#include "saw_ndt/map/ndt_target.h"
#include "saw_ndt/map/voxel_statistics.h"

namespace saw_ndt::internal {

/// What matching reads of a voxel.
struct NdtCell {
  explicit NdtCell(const VoxelStatistics& statistics);

  double mean_from_centre[3];    ///< m
  double inverse_covariance[6];  ///< 1/m^2: xx xy xz yy yz zz
  double weight;                 ///< w_target of the paper
  double mean_confidence;
};

/// The same in single precision, in a cache line of its own.
struct alignas(64) PackedNdtCell {
  PackedNdtCell() = default;
  explicit PackedNdtCell(const VoxelStatistics& statistics);

  float mean_from_centre[3];    ///< m
  float inverse_covariance[6];  ///< 1/m^2: xx xy xz yy yz zz
  float weight;                 ///< w_target of the paper
  float mean_confidence;
  float ground_share;  ///< of the points; matching does not read it
};

/// Whether the surface in a voxel is level: nine tenths of its curvature are vertical.
bool isLevel(const PackedNdtCell& cell);
/// The inverse covariance of a voxel (1/m^2).
Eigen::Matrix3d inverseCovarianceOf(const PackedNdtCell& cell);

/// Cells on their way into a level.
struct NdtCells {
  std::vector<VoxelCoordinate> voxels;
  std::vector<PackedNdtCell> packed;
  std::vector<NdtCell> exact;  ///< as many as `packed`, or none

  void reserve(std::size_t count);
  void add(const std::vector<VoxelStatistics>& statistics, CellPrecision precision);
  void append(NdtCells&& other);
};

/// The cells of one tile (see map_tile.h): so many numbers that follow each other.
struct TileCells {
  Eigen::Vector3i tile = Eigen::Vector3i::Zero();
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

/// The voxels of one resolution that have a distribution, in flat arrays, tile after tile.
class NdtLevel {
 public:
  NdtLevel() = default;
  /// @param cells  in map order (see map_tile.h)
  NdtLevel(double resolution_m, NdtCells cells);

  /// The level of entries in map order, which are of its own voxels.
  /// @param metres_per_step  size of the step in which the sums count
  /// @param threads          0: all cores; the level does not depend on it
  static NdtLevel fromSums(const std::vector<LabelledVoxelSums>& entries, const LevelPlan& plan,
                           const VoxelWeighting& weighting, double metres_per_step, CellPrecision precision,
                           int threads);

  /// Edge of a voxel (m).
  double resolution() const { return resolution_m_; }
  std::size_t size() const { return packed_cells_.size(); }
  bool empty() const { return packed_cells_.empty(); }

  const VoxelIndex& index() const { return index_; }
  const std::vector<PackedNdtCell>& packedCells() const { return packed_cells_; }
  /// The cells in double precision; none unless they were asked for.
  const std::vector<NdtCell>& cells() const { return cells_; }
  /// Whether cells() can be read.
  bool hasDoubleCells() const { return cells_.size() == packed_cells_.size(); }
  /// Which cells are whose, in map order.
  const std::vector<TileCells>& tiles() const { return tiles_; }

  /// The number of the voxel that holds a position in the map frame (m), or VoxelIndex::kNone.
  std::int32_t find(const Eigen::Vector3d& position_m) const;
  /// The means in the map frame (m), by number: exact to about 1e-7 of a voxel.
  std::vector<Eigen::Vector3d> means() const;

 private:
  double resolution_m_ = 1.0;
  std::vector<PackedNdtCell> packed_cells_;
  std::vector<NdtCell> cells_;
  std::vector<TileCells> tiles_;
  VoxelIndex index_;
};

}  // namespace saw_ndt::internal
