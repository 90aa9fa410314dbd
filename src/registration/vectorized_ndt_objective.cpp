#include "registration/vectorized_ndt_objective.h"

#include <algorithm>
#include <functional>
#include <iterator>

#include "common/executor.h"
#include "registration/batch_voxel_finder.h"
#include "registration/pair_parameters.h"

namespace saw_ndt::internal {
namespace {

Matrix6d symmetricFromRows(const double* upper) {
  Matrix6d matrix;
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) matrix(row, column) = matrix(column, row) = *upper++;
  }
  return matrix;
}

void add(const BatchTotals& batch, BatchTotals& total) {
  const auto add_array = [](const auto& values, auto& sums) {
    std::transform(std::begin(values), std::end(values), std::begin(sums), std::begin(sums), std::plus<>());
  };
  total.score += batch.score;
  add_array(batch.pull, total.pull);
  add_array(batch.moment, total.moment);
  add_array(batch.curvature, total.curvature);
  add_array(batch.radial, total.radial);
  total.pair_count += batch.pair_count;
}

}  // namespace

NdtDerivatives VectorizedNdtObjective::evaluate(OrderedSource& source, const Eigen::Isometry3d& T_map_source,
                                                int threads, BatchWorkspace& workspace) const {
  NdtDerivatives derivatives;
  if (!VoxelPairs::reachable(level_, T_map_source)) return derivatives;
  const PairParameters parameters = pairParameters(level_, method_, score_, weighting_);
  const BatchVoxelFinder finder(level_, method_, T_map_source);
  workspace.prepare(threads);
  workspace.batch_totals.resize((source.size() + kPointsPerBatch - 1) / kPointsPerBatch);
  internal::forEachChunk(threads, workspace.batch_totals.size(), [&](std::size_t batch, int worker) {
    BatchScratch& scratch = *workspace.scratch_of_worker[static_cast<std::size_t>(worker)];
    const std::size_t first = batch * kPointsPerBatch;
    finder.find(source, first, std::min(kPointsPerBatch, source.size() - first), scratch);
    workspace.batch_totals[batch] =
        evaluatePairs(scratch.points, source.confidence() + first, scratch.units, scratch.voxels, parameters);
  });
  BatchTotals total{};
  for (const BatchTotals& batch : workspace.batch_totals) add(batch, total);

  derivatives.score = total.score;
  derivatives.force = -score_.d2 * Eigen::Map<const Eigen::Vector3d>(total.pull);
  derivatives.moment = -score_.d2 * Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(total.moment);
  derivatives.curvature = score_.d2 * symmetricFromRows(total.curvature);
  derivatives.radial_curvature = score_.d2 * score_.d2 * symmetricFromRows(total.radial);
  derivatives.pair_count = total.pair_count;
  return derivatives;
}

}  // namespace saw_ndt::internal
