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

std::size_t batchCount(const OrderedSource& source) { return (source.size() + kPointsPerBatch - 1) / kPointsPerBatch; }

}  // namespace

NdtDerivatives VectorizedNdtObjective::evaluate(OrderedSource& source, const Eigen::Isometry3d& T_map_source,
                                                int threads, BatchWorkspace& workspace) const {
  return evaluateAll({{this, &source}}, T_map_source, threads, workspace);
}

NdtDerivatives VectorizedNdtObjective::derivativesOf(const BatchTotals& total) const {
  NdtDerivatives derivatives;
  derivatives.score = total.score;
  derivatives.force = -score_.d2 * Eigen::Map<const Eigen::Vector3d>(total.pull);
  derivatives.moment = -score_.d2 * Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(total.moment);
  derivatives.curvature = score_.d2 * symmetricFromRows(total.curvature);
  derivatives.radial_curvature = score_.d2 * score_.d2 * symmetricFromRows(total.radial);
  derivatives.pair_count = total.pair_count;
  return derivatives;
}

NdtDerivatives evaluateAll(const PartsOfSource& parts, const Eigen::Isometry3d& T_map_source, int threads,
                           BatchWorkspace& workspace) {
  struct Prepared {
    BatchVoxelFinder finder;
    PairParameters parameters;
    std::size_t first_batch, end_batch;
  };
  boost::container::static_vector<Prepared, 2 * kMostLevels> prepared;
  std::size_t batch_count = 0;
  for (const ObjectiveOfPoints& part : parts) {
    const VectorizedNdtObjective& objective = *part.objective;
    const bool reachable = VoxelPairs::reachable(objective.level_, T_map_source);
    const std::size_t end = batch_count + (reachable ? batchCount(*part.points) : 0);
    // The finder of a part without batches finds nothing, but its pose must be one that voxels can be numbered at.
    prepared.push_back({{objective.level_, objective.method_, reachable ? T_map_source : Eigen::Isometry3d::Identity()},
                        pairParameters(objective.level_, objective.method_, objective.score_, objective.weighting_),
                        batch_count,
                        end});
    batch_count = end;
  }
  workspace.prepare(threads);
  workspace.batch_totals.resize(batch_count);
  forEachChunk(threads, batch_count, [&](std::size_t batch, int worker) {
    std::size_t p = 0;
    while (batch >= prepared[p].end_batch) ++p;
    const Prepared& part = prepared[p];
    OrderedSource& points = *parts[p].points;
    BatchScratch& scratch = *workspace.scratch_of_worker[static_cast<std::size_t>(worker)];
    const std::size_t first = (batch - part.first_batch) * kPointsPerBatch;
    part.finder.find(points, first, std::min(kPointsPerBatch, points.size() - first), scratch);
    workspace.batch_totals[batch] =
        evaluatePairs(scratch.points, points.confidence() + first, scratch.units, scratch.voxels, part.parameters);
  });
  NdtDerivatives sum;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    BatchTotals total{};
    for (std::size_t b = prepared[p].first_batch; b < prepared[p].end_batch; ++b) {
      add(workspace.batch_totals[b], total);
    }
    sum += parts[p].objective->derivativesOf(total);
  }
  return sum;
}

}  // namespace saw_ndt::internal
