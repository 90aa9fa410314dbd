#include "registration/likelihoods.h"

#include <algorithm>

#include "common/executor.h"
#include "registration/batch_voxel_finder.h"
#include "registration/pair_parameters.h"

namespace saw_ndt {
namespace {

std::size_t matchedPoints(const BatchScratch& scratch) {
  std::size_t count = 0;
  for (std::size_t u = 0; u < scratch.units.count; ++u) count += scratch.units.units[u].point_count;
  return count;
}

double ratio(double sum, std::size_t count) { return count == 0 ? 0.0 : sum / static_cast<double>(count); }

}  // namespace

Likelihoods evaluateLikelihoods(const internal::NdtLevel& level, OrderedSource& source,
                                const Eigen::Isometry3d& T_map_source, double outlier_ratio, int threads,
                                BatchWorkspace& workspace) {
  Likelihoods likelihoods;
  if (level.empty() || !VoxelPairs::reachable(level, T_map_source)) return likelihoods;
  const PairParameters parameters =
      pairParameters(level, NeighborhoodSearchMethod::DIRECT7,
                     scoreParameters(ScoreFunction::Magnusson, outlier_ratio, level.resolution()), {});
  const BatchVoxelFinder finder(level, NeighborhoodSearchMethod::DIRECT7, T_map_source);
  workspace.prepare(threads);
  workspace.batch_likelihoods.resize((source.size() + kPointsPerBatch - 1) / kPointsPerBatch);
  internal::forEachChunk(threads, workspace.batch_likelihoods.size(), [&](std::size_t batch, int worker) {
    BatchScratch& scratch = *workspace.scratch_of_worker[static_cast<std::size_t>(worker)];
    const std::size_t first = batch * kPointsPerBatch;
    finder.find(source, first, std::min(kPointsPerBatch, source.size() - first), scratch);
    workspace.batch_likelihoods[batch] = {
        evaluateScores(scratch.points, source.nonGround() + first, scratch.units, scratch.voxels, parameters),
        matchedPoints(scratch)};
  });
  LikelihoodSums total;
  for (const LikelihoodSums& sums : workspace.batch_likelihoods) {
    total.scores.all += sums.scores.all;
    total.scores.non_ground += sums.scores.non_ground;
    total.scores.best += sums.scores.best;
    total.matched_points += sums.matched_points;
  }
  likelihoods.unweighted = ratio(total.scores.all, source.size());
  likelihoods.non_ground = ratio(total.scores.non_ground, source.nonGroundCount());
  likelihoods.nearest_voxel = ratio(total.scores.best, total.matched_points);
  return likelihoods;
}

Likelihoods evaluateLikelihoods(const internal::NdtLevel& level, const SourcePoints& source,
                                const Eigen::Isometry3d& T_map_source, double outlier_ratio, int threads) {
  if (level.empty() || !VoxelPairs::reachable(level, T_map_source)) return {};
  OrderedSource ordered;
  ordered.order(source, level.resolution(), ConfidenceOptions::uniform());
  BatchWorkspace workspace;
  return evaluateLikelihoods(level, ordered, T_map_source, outlier_ratio, threads, workspace);
}

}  // namespace saw_ndt
