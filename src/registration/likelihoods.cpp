#include "registration/likelihoods.h"

#include <algorithm>

#include "common/executor.h"
#include "map/ndt_level.h"
#include "registration/batch_voxel_finder.h"
#include "registration/pair_parameters.h"

namespace saw_ndt::internal {
namespace {

constexpr NeighborhoodSearchMethod kNeighbours = NeighborhoodSearchMethod::DIRECT7;

std::size_t matchedPoints(const BatchScratch& scratch) {
  std::size_t count = 0;
  for (std::size_t u = 0; u < scratch.units.count; ++u) count += scratch.units.units[u].point_count;
  return count;
}

double ratio(double sum, std::size_t count) { return count == 0 ? 0.0 : sum / static_cast<double>(count); }

// The score function of voxels of so many metres, whatever the voxels are: large ones would score more, and how well a
// pose explains a scan would depend on how the map is divided.
constexpr double kScoredVoxel_m = 1.0;

PairParameters parametersOf(const NdtLevel& level, double outlier_ratio) {
  return pairParameters(level, kNeighbours, scoreParameters(ScoreFunction::MAGNUSSON, outlier_ratio, kScoredVoxel_m),
                        {});
}

// Of the batch that begins at point `first`, whose voxels have been found.
LikelihoodSums sumsOfBatch(const OrderedSource& source, std::size_t first, const BatchScratch& scratch,
                           const PairParameters& parameters) {
  return {evaluateScores(scratch.points, source.nonGround() + first, scratch.units, scratch.voxels, parameters),
          matchedPoints(scratch)};
}

void add(const LikelihoodSums& batch, LikelihoodSums& total) {
  total.scores.all += batch.scores.all;
  total.scores.non_ground += batch.scores.non_ground;
  total.scores.best += batch.scores.best;
  total.matched_points += batch.matched_points;
}

Likelihoods likelihoodsOf(const LikelihoodSums& total, std::size_t points, std::size_t non_ground_points) {
  return {ratio(total.scores.all, points), ratio(total.scores.non_ground, non_ground_points),
          ratio(total.scores.best, total.matched_points)};
}

LikelihoodSums sumsOf(const NdtLevel& level, OrderedSource& source, const Eigen::Isometry3d& T_map_source,
                      double outlier_ratio, int threads, BatchWorkspace& workspace) {
  LikelihoodSums total;
  if (level.empty() || !VoxelPairs::reachable(level, T_map_source)) return total;
  const PairParameters parameters = parametersOf(level, outlier_ratio);
  const BatchVoxelFinder finder(level, kNeighbours, T_map_source);
  workspace.prepare(threads);
  workspace.batch_likelihoods.resize((source.size() + kPointsPerBatch - 1) / kPointsPerBatch);
  forEachChunk(threads, workspace.batch_likelihoods.size(), [&](std::size_t batch, int worker) {
    BatchScratch& scratch = *workspace.scratch_of_worker[static_cast<std::size_t>(worker)];
    const std::size_t first = batch * kPointsPerBatch;
    finder.find(source, first, std::min(kPointsPerBatch, source.size() - first), scratch);
    workspace.batch_likelihoods[batch] = sumsOfBatch(source, first, scratch, parameters);
  });
  for (const LikelihoodSums& batch : workspace.batch_likelihoods) add(batch, total);
  return total;
}

}  // namespace

Likelihoods evaluateLikelihoods(const NdtTarget& target, LevelledSource& source, const Eigen::Isometry3d& T_map_source,
                                double outlier_ratio, int threads, BatchWorkspace& workspace) {
  LikelihoodSums total;
  for (std::size_t i = 0; i < source.parts().size(); ++i) {
    const NdtLevel& level = target.levels()[source.levelOf(i)];
    add(sumsOf(level, source.parts()[i], T_map_source, outlier_ratio, threads, workspace), total);
  }
  return likelihoodsOf(total, source.size(), source.nonGroundCount());
}

Likelihoods evaluateLikelihoods(const NdtLevel& level, OrderedSource& source, const Eigen::Isometry3d& T_map_source,
                                double outlier_ratio, int threads, BatchWorkspace& workspace) {
  return likelihoodsOf(sumsOf(level, source, T_map_source, outlier_ratio, threads, workspace), source.size(),
                       source.nonGroundCount());
}

Likelihoods likelihoodsInOrder(const NdtLevel& level, const OrderedSource& source,
                               const Eigen::Isometry3d& T_map_source, double outlier_ratio, BatchScratch& scratch) {
  if (level.empty() || !VoxelPairs::reachable(level, T_map_source)) return {};
  const PairParameters parameters = parametersOf(level, outlier_ratio);
  const BatchVoxelFinder finder(level, kNeighbours, T_map_source);
  LikelihoodSums total;
  for (std::size_t first = 0; first < source.size(); first += kPointsPerBatch) {
    finder.findInOrder(source, first, std::min(kPointsPerBatch, source.size() - first), scratch);
    add(sumsOfBatch(source, first, scratch, parameters), total);
  }
  return likelihoodsOf(total, source.size(), source.nonGroundCount());
}

Likelihoods evaluateLikelihoods(const NdtLevel& level, const SourcePoints& source,
                                const Eigen::Isometry3d& T_map_source, double outlier_ratio, int threads) {
  if (level.empty() || !VoxelPairs::reachable(level, T_map_source)) return {};
  OrderedSource ordered;
  ordered.order(source, level.resolution(), ConfidenceOptions::uniform());
  BatchWorkspace workspace;
  return evaluateLikelihoods(level, ordered, T_map_source, outlier_ratio, threads, workspace);
}

}  // namespace saw_ndt::internal
