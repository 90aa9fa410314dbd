#include "saw_ndt/map/ndt_level.h"

#include <Eigen/LU>
#include <algorithm>
#include <iterator>
#include <limits>
#include <stdexcept>

#include "saw_ndt/map/voxel_sums_table.h"

namespace saw_ndt {
namespace {

int floorDivide(int value, int divisor) {
  const int quotient = value / divisor;
  return value % divisor < 0 ? quotient - 1 : quotient;
}

// The sums of a child voxel about the centre of the voxel of `factor` times its size that holds it.
LabelledVoxelSums inParent(const LabelledVoxelSums& child, int factor) {
  LabelledVoxelSums parent{VoxelCoordinate::Zero(), child.label, {}};
  std::array<std::int64_t, 3> shift;
  for (int axis = 0; axis < 3; ++axis) {
    parent.voxel[axis] = floorDivide(child.voxel[axis], factor);
    const std::int64_t place =
        static_cast<std::int64_t>(child.voxel[axis]) - static_cast<std::int64_t>(parent.voxel[axis]) * factor;
    shift[static_cast<std::size_t>(axis)] = (2 * place + 1 - factor) * (kStepsPerVoxel / 2);
  }
  parent.sums = child.sums.shifted(shift);
  return parent;
}

bool inVoxelOrder(const LabelledVoxelSums& a, const LabelledVoxelSums& b) {
  for (const int axis : {2, 1, 0}) {
    if (a.voxel[axis] != b.voxel[axis]) return a.voxel[axis] < b.voxel[axis];
  }
  return a.label < b.label;
}

// Merges the labels of one voxel, `first` to `last`.
std::optional<VoxelStatistics> voxelOf(const LabelledVoxelSums* first, const LabelledVoxelSums* last,
                                       const VoxelWeighting& weighting, double metres_per_step) {
  VoxelSums sums;
  double confidence_sum = 0.0;
  for (const LabelledVoxelSums* entry = first; entry != last; ++entry) {
    const double confidence = weighting.confidence.of(entry->label);
    if (confidence <= 0.0) continue;
    sums += entry->sums;
    confidence_sum += confidence * static_cast<double>(entry->sums.count);
  }
  if (sums.count == 0) return std::nullopt;
  return voxelStatistics(first->voxel, sums, confidence_sum / static_cast<double>(sums.count), weighting,
                         metres_per_step);
}

}  // namespace

PackedNdtCell::PackedNdtCell(const NdtCell& cell)
    : weight(static_cast<float>(cell.weight)), mean_confidence(static_cast<float>(cell.mean_confidence)) {
  const auto to_single = [](double value) { return static_cast<float>(value); };
  std::transform(std::begin(cell.mean_from_centre), std::end(cell.mean_from_centre), mean_from_centre, to_single);
  std::transform(std::begin(cell.inverse_covariance), std::end(cell.inverse_covariance), inverse_covariance, to_single);
}

NdtLevel::NdtLevel(double resolution_m, const std::vector<VoxelStatistics>& voxels) : resolution_m_(resolution_m) {
  if (voxels.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    throw std::length_error("a map level cannot hold more than 2147483647 voxels");
  }
  cells_.reserve(voxels.size());
  voxels_.reserve(voxels.size());
  point_counts_.reserve(voxels.size());
  structure_classes_.reserve(voxels.size());
  for (const VoxelStatistics& v : voxels) {
    const Eigen::Vector3d& mean = v.mean_from_centre;
    const Eigen::Matrix3d& inverse = v.inverse_covariance;
    cells_.push_back({{mean.x(), mean.y(), mean.z()},
                      {inverse(0, 0), inverse(0, 1), inverse(0, 2), inverse(1, 1), inverse(1, 2), inverse(2, 2)},
                      v.weight,
                      v.mean_confidence});
    voxels_.push_back(v.voxel);
    point_counts_.push_back(v.point_count);
    structure_classes_.push_back(v.structure_class);
  }
  packed_cells_ = std::vector<PackedNdtCell>(cells_.begin(), cells_.end());
  index_ = VoxelIndex(voxels_);
}

NdtLevel NdtLevel::fromSums(const std::vector<LabelledVoxelSums>& entries, double resolution_m, int factor,
                            const VoxelWeighting& weighting) {
  std::vector<LabelledVoxelSums> parents;
  if (factor > 1) {
    VoxelSumsTable table;
    for (const LabelledVoxelSums& entry : entries) table.add(inParent(entry, factor));
    parents = table.entries();
    std::sort(parents.begin(), parents.end(), inVoxelOrder);
  }
  const std::vector<LabelledVoxelSums>& grouped = factor > 1 ? parents : entries;

  std::vector<std::size_t> firsts;
  for (std::size_t i = 0; i < grouped.size(); ++i) {
    if (i == 0 || grouped[i].voxel != grouped[i - 1].voxel) firsts.push_back(i);
  }
  firsts.push_back(grouped.size());
  const double metres_per_step = resolution_m / kStepsPerVoxel;
  std::vector<std::optional<VoxelStatistics>> candidates(firsts.size() - 1);
  const auto voxel_count = static_cast<std::ptrdiff_t>(candidates.size());
#pragma omp parallel for schedule(static)
  for (std::ptrdiff_t i = 0; i < voxel_count; ++i) {
    const auto v = static_cast<std::size_t>(i);
    candidates[v] = voxelOf(grouped.data() + firsts[v], grouped.data() + firsts[v + 1], weighting, metres_per_step);
  }
  std::vector<VoxelStatistics> voxels;
  for (const auto& candidate : candidates) {
    if (candidate) voxels.push_back(*candidate);
  }
  return NdtLevel(resolution_m * factor, voxels);
}

VoxelStatistics NdtLevel::voxel(std::size_t i) const {
  const NdtCell& cell = cells_.at(i);
  VoxelStatistics statistics;
  statistics.voxel = voxels_[i];
  statistics.point_count = point_counts_[i];
  statistics.mean_from_centre = Eigen::Map<const Eigen::Vector3d>(cell.mean_from_centre);
  const double* c = cell.inverse_covariance;
  statistics.inverse_covariance << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
  statistics.covariance = statistics.inverse_covariance.inverse();
  statistics.mean_confidence = cell.mean_confidence;
  statistics.structure_class = structure_classes_[i];
  statistics.weight = cell.weight;
  return statistics;
}

std::int32_t NdtLevel::find(const Eigen::Vector3d& position_m) const {
  QuantizedPosition position;
  if (!quantize(position_m, 1.0 / resolution_m_, position)) return VoxelIndex::kNone;
  return index_.find(position.voxel);
}

}  // namespace saw_ndt
