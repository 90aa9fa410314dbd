#pragma once

#include <cstddef>
#include <cstdint>

#include "saw_ndt/map/ndt_level.h"

namespace saw_ndt {

// The inner loops of an evaluation, in single precision, compiled for each instruction set. Points come in batches that
// stay in the first-level cache, in an order in which points of one voxel follow each other: such a run shares its
// voxels, whose values are then broadcast to all lanes instead of being gathered for each.

constexpr std::size_t kPointsPerBatch = 1024;
constexpr std::size_t kMostLanes = 16;
/// Loops write whole vectors, which reach beyond the last point of a batch, and begin at any point.
constexpr std::size_t kBatchRoom = kPointsPerBatch + 2 * kMostLanes;
constexpr std::size_t kMostNeighbours = 27;

/// How source points move to the map. Positions are taken from the lower corner of an origin voxel near the source.
struct BatchPose {
  float rotation[9];     ///< row-major
  float translation[3];  ///< m, from the origin voxel
  float resolution_m;
  float inverse_resolution;
};

/// The points of a batch at one pose, an array a coordinate.
struct alignas(64) BatchPoints {
  float rotated[3][kBatchRoom];         ///< R p (m)
  float from_centre[3][kBatchRoom];     ///< T p from the centre of its own voxel (m)
  std::int32_t voxel[3][kBatchRoom];    ///< its own voxel, counted from the origin voxel
  std::int32_t run_starts[kBatchRoom];  ///< where another voxel begins, then the number of points
  std::size_t run_count;
};

/// Edge of the square of columns that a key tells apart; columns farther out share the keys of nearer ones.
constexpr int kColumnBits = 6;
constexpr std::size_t kColumnKeys = std::size_t{1} << (2 * kColumnBits);

/// Writes for every point the number of the vertical column that it lies in, row by row.
void findColumns(const float* x, const float* y, std::size_t count, float inverse_column_m, std::uint16_t* columns);

/// A voxel that the points of a run pair with.
struct RunVoxel {
  float mean[3];  ///< m, from the centre of the run's own voxel
  std::uint32_t number;
};

/// The voxels of every run of a batch: those of run i are voxels[first[i]] to voxels[first[i + 1] - 1].
struct BatchVoxels {
  std::uint32_t first[kPointsPerBatch + 1];
  RunVoxel voxels[kPointsPerBatch * kMostNeighbours + 1];
};

/// What a pair scores: amplitude * exp(exponent_factor * m * ln 2) of the squared Mahalanobis distance m, and W_ij.
struct PairParameters {
  const PackedNdtCell* cells;
  float amplitude;
  float exponent_factor;  ///< -d2 / 2 / ln 2
  bool weighted;
  float least_compatibility;  ///< lambda_m
  float mismatch_slope;       ///< (1 - lambda_m) / |s_o - s_g|, 0 where the two are alike
  bool within_radius;         ///< only voxels whose mean is no farther than `radius_m`
  float radius_m;
};

/// Sums over the pairs of each point of a batch.
struct alignas(64) BatchSums {
  float score[kBatchRoom];
  float pull[3][kBatchRoom];       ///< sum of W e C^-1 q: minus the force / d2
  float curvature[6][kBatchRoom];  ///< sum of W e C^-1: xx xy xz yy yz zz
  float radial[6][kBatchRoom];     ///< sum of W e C^-1 q q^T C^-1
};

/// The sums of a batch over all of its points, to be multiplied by powers of d2.
struct BatchTotals {
  double score;
  double pull[3];
  double moment[9];      ///< sum of pull r^T, row-major
  double curvature[21];  ///< upper triangle, row by row
  double radial[21];     ///< likewise
  std::size_t pair_count;
};

/// Moves `count` points and finds their runs. The arrays reach 2 kMostLanes finite values beyond the last point.
void transformBatch(const float* x, const float* y, const float* z, std::size_t count, const BatchPose& pose,
                    BatchPoints& points);

/// Sums over the pairs of every point.
/// @param confidence  s of each point; not read unless weighted
/// @return the number of pairs
std::size_t accumulatePairs(const BatchPoints& points, const float* confidence, const BatchVoxels& voxels,
                            const PairParameters& parameters, BatchSums& sums);

/// Adds J^T M J of every point, J = [I, -[r]x], and the rest to the totals.
void addProjectedSums(const BatchPoints& points, std::size_t count, BatchSums& sums, BatchTotals& totals);

/// The score of every point with all weights 1: over all of its pairs (`total`) and of its best one (`best`), 0 where
/// it has none. Both arrays have room for kBatchRoom.
void accumulateScores(const BatchPoints& points, const BatchVoxels& voxels, const PairParameters& parameters,
                      float* total, float* best);

}  // namespace saw_ndt
