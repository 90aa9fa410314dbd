#include "saw_ndt/localization/source_voxel_filter.h"

#include <algorithm>
#include <cmath>

#include "saw_ndt/common/error.h"
#include "saw_ndt/map/voxel_sums_table.h"

namespace saw_ndt {
namespace {

constexpr std::uint32_t kEmpty = 0xFFFFFFFFu;
constexpr std::size_t kLeastSlots = 1u << 17;
constexpr float kFarthestVoxel = 2.0e9f;

}  // namespace

SourceVoxelFilter::SourceVoxelFilter(double voxel_size_m) : voxel_size_m_(voxel_size_m), slots_(kLeastSlots, kEmpty) {
  checkOption(voxel_size_m >= 0.0 && std::isfinite(voxel_size_m), "source_voxel_size_m", voxel_size_m, "0 or more");
  inverse_size_ = voxel_size_m > 0.0 ? static_cast<float>(1.0 / voxel_size_m) : 0.0f;
}

void SourceVoxelFilter::start(bool labelled) {
  points_.clear();
  points_.labelled = labelled;
  cells_.clear();
  std::fill(slots_.begin(), slots_.end(), kEmpty);
}

std::size_t SourceVoxelFilter::find(const Eigen::Vector3i& voxel, StructuralLabel label) const {
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = (hashCoordinate(voxel) + static_cast<std::uint32_t>(label) * 0x9E3779B9u) & mask;
  while (slots_[slot] != kEmpty) {
    const Cell& cell = cells_[slots_[slot]];
    if (cell.voxel == voxel && cell.label == label) break;
    slot = (slot + 1) & mask;
  }
  return slot;
}

void SourceVoxelFilter::grow() {
  slots_.assign(2 * slots_.size(), kEmpty);
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    slots_[find(cells_[i].voxel, cells_[i].label)] = static_cast<std::uint32_t>(i);
  }
}

void SourceVoxelFilter::add(const Eigen::Vector3f& point, StructuralLabel label) {
  if (voxel_size_m_ <= 0.0) {
    if (point.allFinite()) points_.add(point.x(), point.y(), point.z(), label);
    return;
  }
  const Eigen::Vector3f voxel = (point * inverse_size_).array().floor();
  // One by one: maxCoeff() passes over a NaN that is not the first coefficient.
  if (!(voxel.array().abs() < kFarthestVoxel).all()) return;
  const Eigen::Vector3i coordinate = voxel.cast<int>();
  const std::size_t slot = find(coordinate, label);
  std::uint32_t number = slots_[slot];
  if (number == kEmpty) {
    number = slots_[slot] = static_cast<std::uint32_t>(cells_.size());
    cells_.push_back({coordinate, label, 0, Eigen::Vector3f::Zero()});
    if (2 * cells_.size() > slots_.size()) grow();
  }
  Cell& cell = cells_[number];
  ++cell.count;
  cell.offset_sum += point - voxel * static_cast<float>(voxel_size_m_);
}

const SourcePoints& SourceVoxelFilter::finish() {
  for (const Cell& cell : cells_) {
    const Eigen::Vector3f centroid =
        cell.voxel.cast<float>() * static_cast<float>(voxel_size_m_) + cell.offset_sum / static_cast<float>(cell.count);
    points_.add(centroid.x(), centroid.y(), centroid.z(), cell.label);
  }
  cells_.clear();
  return points_;
}

}  // namespace saw_ndt
