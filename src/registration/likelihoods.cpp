#include "saw_ndt/registration/likelihoods.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "voxel_pairs.h"

namespace saw_ndt {
namespace {

struct Sums {
  double all = 0.0, non_ground = 0.0, best = 0.0;
  std::size_t non_ground_points = 0, matched_points = 0;
};

Sums sumBlock(const NdtLevel& level, const SourcePoints& source, const Eigen::Isometry3d& T_map_source,
              const ScoreParameters& parameters, std::size_t first, std::size_t last) {
  Sums sums;
  VoxelPairs pairs(level, T_map_source);
  for (std::size_t i = first; i < last; ++i) {
    const Eigen::Vector3d r = T_map_source.linear() * Eigen::Vector3d(source.x[i], source.y[i], source.z[i]);
    double total = 0.0, best = 0.0;
    bool matched = false;
    pairs.forEach<NeighborhoodSearchMethod::DIRECT7>(r, [&](const NdtCell& cell, double qx, double qy, double qz) {
      const double exponent = 0.5 * parameters.d2 * WhitenedOffset(cell, qx, qy, qz).squared_mahalanobis;
      const double score = exponent > kLargestExponent ? 0.0 : parameters.amplitude * std::exp(-exponent);
      total += score;
      best = std::max(best, score);
      matched = true;
    });
    sums.all += total;
    sums.best += best;
    sums.matched_points += matched;
    if (source.label[i] != static_cast<std::uint8_t>(StructuralLabel::Ground)) {
      sums.non_ground += total;
      ++sums.non_ground_points;
    }
  }
  return sums;
}

double ratio(double sum, std::size_t count) { return count == 0 ? 0.0 : sum / static_cast<double>(count); }

}  // namespace

Likelihoods evaluateLikelihoods(const NdtLevel& level, const SourcePoints& source,
                                const Eigen::Isometry3d& T_map_source, double outlier_ratio, int threads) {
  Likelihoods likelihoods;
  if (level.empty() || !VoxelPairs::reachable(level, T_map_source)) return likelihoods;
  const ScoreParameters parameters = scoreParameters(ScoreFunction::Magnusson, outlier_ratio, level.resolution());
  constexpr std::size_t kPointsPerBlock = 2048;
  const auto block_count = static_cast<std::ptrdiff_t>((source.size() + kPointsPerBlock - 1) / kPointsPerBlock);
  std::vector<Sums> blocks(static_cast<std::size_t>(block_count));
#pragma omp parallel for schedule(dynamic) num_threads(threads)
  for (std::ptrdiff_t b = 0; b < block_count; ++b) {
    const std::size_t first = static_cast<std::size_t>(b) * kPointsPerBlock;
    blocks[static_cast<std::size_t>(b)] =
        sumBlock(level, source, T_map_source, parameters, first, std::min(first + kPointsPerBlock, source.size()));
  }
  Sums total;
  for (const Sums& sums : blocks) {
    total.all += sums.all;
    total.non_ground += sums.non_ground;
    total.best += sums.best;
    total.non_ground_points += sums.non_ground_points;
    total.matched_points += sums.matched_points;
  }
  likelihoods.unweighted = ratio(total.all, source.size());
  likelihoods.non_ground = ratio(total.non_ground, total.non_ground_points);
  likelihoods.nearest_voxel = ratio(total.best, total.matched_points);
  return likelihoods;
}

}  // namespace saw_ndt
