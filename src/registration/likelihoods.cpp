#include "saw_ndt/registration/likelihoods.h"

#include <omp.h>

#include <algorithm>

#include "registration/pair_parameters.h"
#include "registration/batch_voxel_finder.h"

namespace saw_ndt {
namespace {

LikelihoodSums sumBatch(const BatchScratch& scratch, const float* total, const float* best,
                        const std::uint8_t* labels) {
  LikelihoodSums sums;
  const BatchPoints& points = scratch.points;
  for (std::size_t run = 0; run < points.run_count; ++run) {
    const auto begin = static_cast<std::size_t>(points.run_starts[run]);
    const auto end = static_cast<std::size_t>(points.run_starts[run + 1]);
    if (scratch.voxels.first[run] != scratch.voxels.first[run + 1]) sums.matched_points += end - begin;
  }
  const auto count = static_cast<std::size_t>(points.run_starts[points.run_count]);
  for (std::size_t i = 0; i < count; ++i) {
    const bool non_ground = labels[i] != static_cast<std::uint8_t>(StructuralLabel::Ground);
    sums.all += static_cast<double>(total[i]);
    sums.best += static_cast<double>(best[i]);
    sums.non_ground += non_ground ? static_cast<double>(total[i]) : 0.0;
    sums.non_ground_points += non_ground ? 1 : 0;
  }
  return sums;
}

double ratio(double sum, std::size_t count) { return count == 0 ? 0.0 : sum / static_cast<double>(count); }

}  // namespace

Likelihoods evaluateLikelihoods(const NdtLevel& level, OrderedSource& source, const Eigen::Isometry3d& T_map_source,
                                double outlier_ratio, int threads, BatchWorkspace& workspace) {
  Likelihoods likelihoods;
  if (level.empty() || !VoxelPairs::reachable(level, T_map_source)) return likelihoods;
  const PairParameters parameters =
      pairParameters(level, NeighborhoodSearchMethod::DIRECT7,
                     scoreParameters(ScoreFunction::Magnusson, outlier_ratio, level.resolution()), {});
  workspace.prepare(threads);
  workspace.batch_likelihoods.resize((source.size() + kPointsPerBatch - 1) / kPointsPerBatch);
  const auto batch_count = static_cast<std::ptrdiff_t>(workspace.batch_likelihoods.size());
#pragma omp parallel num_threads(threads)
  {
    BatchScratch& scratch = *workspace.scratch_of_thread[static_cast<std::size_t>(omp_get_thread_num())];
    BatchVoxelFinder finder(level, NeighborhoodSearchMethod::DIRECT7, T_map_source);
    float* const total = scratch.sums.score;
    float* const best = scratch.sums.pull[0];
#pragma omp for schedule(dynamic)
    for (std::ptrdiff_t b = 0; b < batch_count; ++b) {
      const std::size_t first = static_cast<std::size_t>(b) * kPointsPerBatch;
      finder.find(source, first, std::min(kPointsPerBatch, source.size() - first), scratch);
      accumulateScores(scratch.points, scratch.voxels, parameters, total, best);
      workspace.batch_likelihoods[static_cast<std::size_t>(b)] = sumBatch(scratch, total, best, source.label() + first);
    }
  }
  LikelihoodSums total;
  for (const LikelihoodSums& sums : workspace.batch_likelihoods) {
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

Likelihoods evaluateLikelihoods(const NdtLevel& level, const SourcePoints& source,
                                const Eigen::Isometry3d& T_map_source, double outlier_ratio, int threads) {
  if (level.empty() || !VoxelPairs::reachable(level, T_map_source)) return {};
  OrderedSource ordered;
  ordered.order(source, level.resolution(), ConfidenceOptions::uniform());
  BatchWorkspace workspace;
  return evaluateLikelihoods(level, ordered, T_map_source, outlier_ratio, threads, workspace);
}

}  // namespace saw_ndt
