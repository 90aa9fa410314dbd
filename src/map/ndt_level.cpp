#include "map/ndt_level.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include "map/map_tile.h"
#include "map/sums_statistics.h"

namespace saw_ndt::internal {
namespace {

template <typename Cell>
void fill(Cell& cell, const VoxelStatistics& statistics) {
  const auto put = [](double value, auto& field) { field = static_cast<std::decay_t<decltype(field)>>(value); };
  int k = 0;
  for (int i = 0; i < 3; ++i) {
    put(statistics.mean_from_centre[i], cell.mean_from_centre[i]);
    for (int j = i; j < 3; ++j, ++k) put(statistics.inverse_covariance(i, j), cell.inverse_covariance[k]);
  }
  put(statistics.weight, cell.weight);
  put(statistics.mean_confidence, cell.mean_confidence);
}

template <typename Value>
void appendTo(std::vector<Value>& whole, std::vector<Value>&& part) {
  if (whole.capacity() == 0) {
    whole = std::move(part);
  } else {
    whole.insert(whole.end(), part.begin(), part.end());
  }
}

}  // namespace

NdtCell::NdtCell(const VoxelStatistics& statistics) { fill(*this, statistics); }
PackedNdtCell::PackedNdtCell(const VoxelStatistics& statistics) {
  fill(*this, statistics);
  ground_share = static_cast<float>(statistics.ground_share);
}

bool isLevel(const PackedNdtCell& cell) {
  constexpr float kLevelShare = 0.9F;
  const float* const c = cell.inverse_covariance;
  return c[5] >= kLevelShare * (c[0] + c[3] + c[5]);
}

Eigen::Matrix3d inverseCovarianceOf(const PackedNdtCell& cell) {
  const float* const c = cell.inverse_covariance;
  Eigen::Matrix3d inverse_covariance;
  inverse_covariance << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
  return inverse_covariance;
}

void NdtCells::reserve(std::size_t count) {
  voxels.reserve(count);
  packed.reserve(count);
}

void NdtCells::add(const std::vector<VoxelStatistics>& statistics, CellPrecision precision) {
  for (const VoxelStatistics& voxel : statistics) {
    voxels.push_back(voxel.voxel);
    packed.emplace_back(voxel);
    if (precision == CellPrecision::SINGLE_AND_DOUBLE) exact.emplace_back(voxel);
  }
}

void NdtCells::append(NdtCells&& other) {
  appendTo(voxels, std::move(other.voxels));
  appendTo(packed, std::move(other.packed));
  appendTo(exact, std::move(other.exact));
}

NdtLevel::NdtLevel(double resolution_m, NdtCells cells)
    : resolution_m_(resolution_m), packed_cells_(std::move(cells.packed)), cells_(std::move(cells.exact)) {
  if (packed_cells_.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    throw std::length_error("a map level cannot hold more than 2147483647 voxels");
  }
  for (std::size_t i = 0; i < cells.voxels.size(); ++i) {
    const Eigen::Vector3i tile = tileOf(cells.voxels[i]);
    if (tiles_.empty() || tiles_.back().tile != tile) tiles_.push_back({tile, static_cast<std::uint32_t>(i), 0});
    ++tiles_.back().count;
  }
  index_ = VoxelIndex(cells.voxels);
}

NdtLevel NdtLevel::fromSums(const std::vector<LabelledVoxelSums>& entries, const LevelPlan& plan,
                            const VoxelWeighting& weighting, double metres_per_step, CellPrecision precision,
                            int threads) {
  std::vector<NdtCells> parts;
  forEachPartOfVoxels(
      entries, threads, [&parts](std::size_t part_count) { parts.resize(part_count); },
      [&](std::size_t part, const LabelledVoxelSums* first, const LabelledVoxelSums* last) {
        forEachStatistics(
            first, last, weighting, plan, metres_per_step,
            [&](const std::vector<VoxelStatistics>& statistics) { parts[part].add(statistics, precision); });
      });
  NdtCells whole;
  for (NdtCells& part : parts) whole.append(std::exchange(part, {}));
  return NdtLevel(plan.resolution_m, std::move(whole));
}

std::int32_t NdtLevel::find(const Eigen::Vector3d& position_m) const {
  QuantizedPosition position;
  if (!quantize(position_m, 1.0 / resolution_m_, position)) return VoxelIndex::kNone;
  return index_.find(position.voxel);
}

std::vector<Eigen::Vector3d> NdtLevel::means() const {
  const std::vector<VoxelCoordinate> voxels = index_.voxels();
  std::vector<Eigen::Vector3d> means(voxels.size());
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const Eigen::Map<const Eigen::Vector3f> from_centre(packed_cells_[i].mean_from_centre);
    means[i] = (voxels[i].cast<double>().array() + 0.5).matrix() * resolution_m_ + from_centre.cast<double>();
  }
  return means;
}

}  // namespace saw_ndt::internal
