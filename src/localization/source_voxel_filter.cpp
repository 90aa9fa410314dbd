#include "localization/source_voxel_filter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "common/no_return.h"
#include "localization/motion_compensation.h"
#include "localization/source_voxel_loops.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {
namespace {

constexpr std::size_t kBlock = SourceVoxelBlock::kSize;
// The hardware follows the stream of points to the end of a page alone.
constexpr std::size_t kPointsAhead = 96;
constexpr int kMinSlotBits = 17;
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
  hash_shift_ = 64 - kMinSlotBits + 1;
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
  for (std::size_t label = 0; label < takes_label_.size(); ++label) {
    takes_label_[label] = selection.confidence.of(static_cast<StructuralLabel>(label)) > 0.0;
  }
  points_.clear();
  points_.labelled = labels != nullptr;
  times_s_.clear();
  const bool timed = selection.clock != nullptr;
  if (voxel_size_m_ > 0.0) startVoxels();
  const Eigen::Isometry3f T_base_lidar = selection.T_base_lidar.cast<float>();
  const RigidTransformRows transform = rowsOf(T_base_lidar);
  const bool is_identity = T_base_lidar.matrix() == Eigen::Matrix4f::Identity();
  for (std::size_t begin = 0; begin < scan.size; begin += kBlock) {
    const std::size_t end = std::min(begin + kBlock, scan.size);
    const std::size_t count =
        select(scan, begin, end, labels != nullptr ? labels->data() : nullptr, selection.clock, ground_sampler);
    if (!is_identity) transformPoints(count, transform, *block_);
    if (voxel_size_m_ > 0.0) {
      addToVoxels(count, timed);
    } else {
      addPoints(count, timed);
    }
  }
  if (voxel_size_m_ > 0.0) finishVoxels(timed);
  return points_;
}

std::size_t SourceVoxelFilter::select(const ScanView& scan, std::size_t begin, std::size_t end,
                                      const StructuralLabel* labels, const ScanClock* clock,
                                      GroundSampler& ground_sampler) {
  SourceVoxelBlock& block = *block_;
  const std::size_t stride = scan.stride;
  const float* const first = scan.point(begin);
  const auto read = [&](std::size_t place, std::size_t i) {
    const float* const point = first + i * stride;
    __builtin_prefetch(point + kPointsAhead * stride);
    block.x[place] = isReturn(point) ? point[0] : std::numeric_limits<float>::quiet_NaN();
    block.y[place] = point[1];
    block.z[place] = point[2];
  };
  const std::size_t size = end - begin;
  if (labels == nullptr) {
    if (!takes_label_[static_cast<std::size_t>(StructuralLabel::NON_GROUND)]) return 0;
    for (std::size_t i = 0; i < size; ++i) read(i, i);
    if (clock != nullptr) readTimes(scan, *clock, begin, size, nullptr);
    std::fill_n(block.label, size, static_cast<std::uint8_t>(StructuralLabel::NON_GROUND));
    return size;
  }
  // Which points are taken changes too often to be a branch: one that is not is overwritten by the next.
  std::array<std::uint16_t, kBlock> taken;
  const std::array<bool, kStructuralLabelCount> takes_label = takes_label_;
  GroundSampler sampler = ground_sampler;
  std::size_t count = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const StructuralLabel label = labels[begin + i];
    const bool takes = takes_label[static_cast<std::size_t>(label)];
    taken[count] = static_cast<std::uint16_t>(i);
    block.label[count] = static_cast<std::uint8_t>(label);
    const bool sampled = sampler.keepsNext(takes & (label == StructuralLabel::GROUND));
    count += static_cast<std::size_t>(takes & sampled);
  }
  ground_sampler = sampler;
  for (std::size_t place = 0; place < count; ++place) read(place, taken[place]);
  if (clock != nullptr) readTimes(scan, *clock, begin, count, taken.data());
  return count;
}

void SourceVoxelFilter::readTimes(const ScanView& scan, const ScanClock& clock, std::size_t begin, std::size_t count,
                                  const std::uint16_t* taken) {
  block_times_s_.resize(kBlock);
  for (std::size_t place = 0; place < count; ++place) {
    const float time_s = clock(scan.times_s[begin + (taken != nullptr ? taken[place] : place)]);
    block_times_s_[place] = std::isfinite(time_s) ? time_s : 0.0F;
  }
}

void SourceVoxelFilter::addPoints(std::size_t count, bool timed) {
  const SourceVoxelBlock& block = *block_;
  for (std::size_t i = 0; i < count; ++i) {
    if (!isWithinReach(block.x[i], block.y[i], block.z[i])) continue;
    points_.add(block.x[i], block.y[i], block.z[i], static_cast<StructuralLabel>(block.label[i]));
    if (timed) times_s_.push_back(block_times_s_[i]);
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
  first_number_ = 1;
  const std::size_t mask = slots_.size() - 1;
  for (std::uint32_t voxel = 0; voxel < voxel_count_; ++voxel) {
    std::size_t slot = keys_[voxel] * kHashFactor >> hash_shift_;
    while (slots_[slot] != 0) slot = (slot + 1) & mask;
    slots_[slot] = first_number_ + voxel;
  }
}

void SourceVoxelFilter::numberVoxels(std::size_t count, const std::uint64_t* keys, std::uint32_t* numbers) {
  while (voxel_count_ + count > slots_.size() / 2) growTable();
  std::uint32_t* const slots = slots_.data();
  std::uint64_t* const known_keys = keys_.data();
  float* const offset_sums = offset_sums_.data();
  const std::size_t mask = slots_.size() - 1;
  const int hash_shift = hash_shift_;
  const std::uint32_t first_number = first_number_;
  std::uint32_t voxel_count = voxel_count_;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t key = keys[i];
    if (key == kNoVoxel) {
      numbers[i] = static_cast<std::uint32_t>(keys_.size() - 1);  // of no voxel
      continue;
    }
    // A voxel is as often new as not, so that must not be a branch: the next new one is made ready, and taken where the
    // slot is empty.
    known_keys[voxel_count] = key;
    std::fill_n(offset_sums + 4 * std::size_t{voxel_count}, 4, 0.0F);
    std::size_t slot = key * kHashFactor >> hash_shift;
    std::uint32_t number = std::min(slots[slot] - first_number, voxel_count);
    while (known_keys[number] != key) {
      slot = (slot + 1) & mask;
      number = std::min(slots[slot] - first_number, voxel_count);
    }
    slots[slot] = first_number + number;
    voxel_count += static_cast<std::uint32_t>(number == voxel_count);
    numbers[i] = number;
  }
  voxel_count_ = voxel_count;
}

void SourceVoxelFilter::addToVoxels(std::size_t count, bool timed) {
  if (count == 0) return;
  SourceVoxelBlock& block = *block_;
  findVoxels(count, static_cast<float>(voxel_size_m_), inverse_size_, block);

  // Points of a ring share a voxel with those before them as often as not: each such run is looked up once.
  std::array<std::uint64_t, kBlock> keys;
  std::array<std::uint16_t, kBlock> ordinals;
  std::array<std::uint32_t, kBlock> numbers;
  std::size_t last = 0;
  std::uint64_t previous = block.keyAt(0);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t key = block.keyAt(i);
    last += static_cast<std::size_t>(key != previous);
    keys[last] = key;
    ordinals[i] = static_cast<std::uint16_t>(last);
    previous = key;
  }
  numberVoxels(last + 1, keys.data(), numbers.data());
  addOffsets(count, block.offset, ordinals.data(), numbers.data(), offset_sums_.data());
  if (!timed) return;
  times_s_.resize(keys_.size());  // new voxels begin at 0
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t number = numbers[ordinals[i]];
    if (number < voxel_count_) times_s_[number] += block_times_s_[i];
  }
}

void SourceVoxelFilter::finishVoxels(bool timed) {
  points_.x.resize(voxel_count_);
  points_.y.resize(voxel_count_);
  points_.z.resize(voxel_count_);
  points_.label.resize(voxel_count_);
  findCentroids(voxel_count_, static_cast<float>(voxel_size_m_), keys_.data(), offset_sums_.data(), points_.x.data(),
                points_.y.data(), points_.z.data(), points_.label.data());
  if (!timed) return;
  times_s_.resize(voxel_count_);
  for (std::size_t voxel = 0; voxel < voxel_count_; ++voxel) times_s_[voxel] /= offset_sums_[4 * voxel + 3];
}

}  // namespace saw_ndt::internal
