#include "saw_ndt/localization/source_voxel_filter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "localization/source_voxel_loops.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt {
namespace {

constexpr std::size_t kBlock = SourceVoxelBlock::kSize;
constexpr int kLeastSlotBits = 17;
constexpr std::uint64_t kHashFactor = 0x9E3779B97F4A7C15ULL;

RigidTransformRows rowsOf(const Eigen::Isometry3f& transform) {
  RigidTransformRows rows;
  Eigen::Map<Eigen::Matrix<float, 3, 4, Eigen::RowMajor>>(rows.row) = transform.matrix().topRows<3>();
  return rows;
}

}  // namespace

SourceVoxelFilter::SourceVoxelFilter(double voxel_size_m)
    : voxel_size_m_(voxel_size_m), block_(std::make_unique<SourceVoxelBlock>()) {
  checkOption(voxel_size_m >= 0.0 && std::isfinite(voxel_size_m), "source_voxel_size_m", voxel_size_m, "0 or more");
  inverse_size_ = voxel_size_m > 0.0 ? static_cast<float>(1.0 / voxel_size_m) : 0.0F;
  hash_shift_ = 64 - kLeastSlotBits + 1;
  if (voxel_size_m > 0.0) growTable();
}

SourceVoxelFilter::~SourceVoxelFilter() = default;
SourceVoxelFilter::SourceVoxelFilter(SourceVoxelFilter&& other) noexcept = default;
SourceVoxelFilter& SourceVoxelFilter::operator=(SourceVoxelFilter&& other) noexcept = default;

const SourcePoints& SourceVoxelFilter::filter(const ScanView& scan, const std::vector<StructuralLabel>* labels,
                                              const SourceSelection& selection) {
  if (labels != nullptr && labels->size() != scan.size) {
    throw std::invalid_argument("labels: " + std::to_string(labels->size()) + " for " + std::to_string(scan.size) +
                                " points");
  }
  GroundSampler ground_sampler({selection.ground_ratio});
  for (int label = 0; label < kStructuralLabelCount; ++label) {
    takes_label_[label] = selection.confidence.of(static_cast<StructuralLabel>(label)) > 0.0;
  }
  points_.clear();
  points_.labelled = labels != nullptr;
  if (voxel_size_m_ > 0.0) startVoxels();
  const Eigen::Isometry3f T_base_lidar = selection.T_base_lidar.cast<float>();
  const RigidTransformRows transform = rowsOf(T_base_lidar);
  const bool is_identity = T_base_lidar.matrix() == Eigen::Matrix4f::Identity();
  for (std::size_t begin = 0; begin < scan.size; begin += kBlock) {
    const std::size_t end = std::min(begin + kBlock, scan.size);
    const std::size_t count = select(scan, begin, end, labels != nullptr ? labels->data() : nullptr, ground_sampler);
    if (!is_identity) transformPoints(count, transform, *block_);
    if (voxel_size_m_ > 0.0) {
      addToVoxels(count);
    } else {
      addPoints(count);
    }
  }
  if (voxel_size_m_ > 0.0) finishVoxels();
  return points_;
}

std::size_t SourceVoxelFilter::select(const ScanView& scan, std::size_t begin, std::size_t end,
                                      const StructuralLabel* labels, GroundSampler& ground_sampler) {
  SourceVoxelBlock& block = *block_;
  const auto take = [&](std::size_t i, std::size_t place) {
    const float* const point = scan.point(i);
    block.x[place] = point[0];
    block.y[place] = point[1];
    block.z[place] = point[2];
  };
  if (labels == nullptr) {
    if (!takes_label_[static_cast<int>(StructuralLabel::NonGround)]) return 0;
    for (std::size_t i = begin; i < end; ++i) take(i, i - begin);
    std::fill_n(block.label, end - begin, static_cast<std::uint8_t>(StructuralLabel::NonGround));
    return end - begin;
  }
  // Which points are taken changes too often to be a branch: one that is not is overwritten by the next.
  std::size_t count = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const auto label = static_cast<std::uint8_t>(labels[i]);
    take(i, count);
    block.label[count] = label;
    const bool sampled = ground_sampler.keepsNext(takes_label_[label] & (labels[i] == StructuralLabel::Ground));
    count += static_cast<std::size_t>(takes_label_[label] & sampled);
  }
  return count;
}

void SourceVoxelFilter::addPoints(std::size_t count) {
  const SourceVoxelBlock& block = *block_;
  for (std::size_t i = 0; i < count; ++i) {
    if (!std::isfinite(block.x[i]) || !std::isfinite(block.y[i]) || !std::isfinite(block.z[i])) continue;
    points_.add(block.x[i], block.y[i], block.z[i], static_cast<StructuralLabel>(block.label[i]));
  }
}

void SourceVoxelFilter::startVoxels() {
  first_number_ += voxel_count_;
  voxel_count_ = 0;
  if (first_number_ > 0 && first_number_ < (1U << 31)) return;
  std::fill(slots_.begin(), slots_.end(), 0);
  first_number_ = 1;
}

void SourceVoxelFilter::growTable() {
  --hash_shift_;
  slots_.assign(std::size_t{1} << (64 - hash_shift_), 0);
  keys_.resize(slots_.size() / 2 + 1);
  offset_sums_.resize(4 * keys_.size());
  const std::uint32_t voxels = voxel_count_;
  first_number_ = 1;
  for (voxel_count_ = 0; voxel_count_ < voxels;) numberOf(keys_[voxel_count_]);
}

inline std::uint32_t SourceVoxelFilter::numberOf(std::uint64_t key) {
  const std::size_t mask = slots_.size() - 1;
  keys_[voxel_count_] = key;
  for (std::size_t slot = key * kHashFactor >> hash_shift_;; slot = (slot + 1) & mask) {
    // A voxel is as often new as not: no branch, but the number of the next one where the slot is empty.
    const std::uint32_t held = slots_[slot] - first_number_;
    const std::uint32_t number = held < voxel_count_ ? held : voxel_count_;
    if (keys_[number] != key) continue;
    slots_[slot] = first_number_ + number;
    voxel_count_ += static_cast<std::uint32_t>(number == voxel_count_);
    return number;
  }
}

void SourceVoxelFilter::addToVoxels(std::size_t count) {
  SourceVoxelBlock& block = *block_;
  findVoxels(count, static_cast<float>(voxel_size_m_), inverse_size_, block);

  // Points of a ring share a voxel with those before them as often as not: each such run is looked up once.
  std::array<std::uint64_t, kBlock> keys;
  std::array<std::uint16_t, kBlock> ordinals;
  std::array<std::uint32_t, kBlock> numbers;
  std::size_t last = 0;
  for (std::size_t i = 0; i < count; ++i) {
    last += static_cast<std::size_t>(i > 0 && block.key[i] != keys[last]);
    keys[last] = block.key[i];
    ordinals[i] = static_cast<std::uint16_t>(last);
  }
  const std::size_t runs = count > 0 ? last + 1 : 0;
  while (voxel_count_ + kBlock > slots_.size() / 2) growTable();
  const auto no_voxel = static_cast<std::uint32_t>(keys_.size() - 1);
  for (std::size_t run = 0; run < runs; ++run) {
    std::fill_n(offset_sums_.data() + 4 * std::size_t{voxel_count_}, 4, 0.0F);
    numbers[run] = keys[run] == kNoVoxel ? no_voxel : numberOf(keys[run]);
  }
  addOffsets(count, block.offset, ordinals.data(), numbers.data(), offset_sums_.data());
}

void SourceVoxelFilter::finishVoxels() {
  points_.x.resize(voxel_count_);
  points_.y.resize(voxel_count_);
  points_.z.resize(voxel_count_);
  points_.label.resize(voxel_count_);
  findCentroids(voxel_count_, static_cast<float>(voxel_size_m_), keys_.data(), offset_sums_.data(), points_.x.data(),
                points_.y.data(), points_.z.data(), points_.label.data());
}

}  // namespace saw_ndt
