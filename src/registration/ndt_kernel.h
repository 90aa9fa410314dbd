#pragma once

#include <cstddef>
#include <cstdint>

#include "map/ndt_level.h"
#include "registration/batch_transform.h"

namespace saw_ndt::internal {

// The inner loops of an evaluation, in single precision, compiled for each instruction set. Points come in batches,
// in an order in which points of one voxel follow each other. Such a run shares its
// voxels. It is cut into units of a few points, and a vector holds as many units as have room: each of its 128-bit
// blocks has a unit and the voxel of that unit, whose values are loaded once and broadcast within the block instead of
// being gathered for each point.

constexpr std::size_t kMostNeighbours = 27;

/// A voxel that the points of a run pair with.
struct alignas(16) RunVoxel {
  float mean[3];  ///< m, from the centre of the run's own voxel
  std::uint32_t number;
};

/// The voxels of every run of a batch: those of run i are voxels[first[i]] to voxels[first[i + 1] - 1].
struct BatchVoxels {
  std::uint32_t first[kPointsPerBatch + 1];
  RunVoxel voxels[kPointsPerBatch * kMostNeighbours + 1];
};

/// Points of one run that share a block of a vector.
struct PointUnit {
  std::uint16_t first_point;
  std::uint8_t point_count;   ///< 1 to pointsPerUnit(), or 0 for what only fills a vector
  std::uint8_t voxel_count;   ///< voxels that the run pairs with, not 0; alike for all units of a vector
  std::uint32_t first_voxel;  ///< in BatchVoxels::voxels
};

/// The units of a batch. Points of runs without voxels are in none.
struct BatchUnits {
  std::size_t count;  ///< a whole number of vectors
  PointUnit units[kPointsPerBatch + kMostNeighbours * kMostLanes];
};

/// How many points a unit holds at most, and how many units a vector holds, for the instruction set in use.
std::size_t pointsPerUnit();
std::size_t unitsPerVector();

/// What a pair scores: amplitude * exp(exponent_factor * m * ln 2) of the squared Mahalanobis distance m, and W_ij.
struct PairParameters {
  const internal::PackedNdtCell* cells;
  float amplitude;
  float exponent_factor;  ///< -d2 / 2 / ln 2
  bool weighted;
  float min_compatibility;  ///< lambda_m
  float mismatch_slope;     ///< (1 - lambda_m) / |s_o - s_g|, 0 where the two are alike
  bool within_radius;       ///< only voxels whose mean is no farther than `radius_m`
  float radius_m;
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

/// Sums over all pairs of a batch, J^T M J of every point among them, J = [I, -[r]x].
/// @param confidence  s of each point; not read unless weighted
BatchTotals evaluatePairs(const BatchPoints& points, const float* confidence, const BatchUnits& units,
                          const BatchVoxels& voxels, const PairParameters& parameters);

/// Sums of the scores of a batch with all weights 1.
struct BatchScores {
  double all;         ///< over all pairs
  double non_ground;  ///< over all pairs of points that are not ground
  double best;        ///< over the best pair of each point
};

/// @param non_ground  of each point 1 where it is not ground, otherwise 0
BatchScores evaluateScores(const BatchPoints& points, const float* non_ground, const BatchUnits& units,
                           const BatchVoxels& voxels, const PairParameters& parameters);

}  // namespace saw_ndt::internal
