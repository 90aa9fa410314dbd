#include "registration/ordered_source.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "common/executor.h"
#include "registration/batch_transform.h"

namespace saw_ndt::internal {
namespace {

// Behind the last point, for vectors that reach beyond it.
constexpr std::size_t kRoomBehind = 2 * kMostLanes;

// A column is as wide as so many voxels: wide enough that a batch holds whole voxels of several columns.
constexpr double kVoxelsPerColumn = 8.0;

// How many parts of the points are put in order side by side.
constexpr std::size_t kParts = 4;

// How many parts they can be dealt out to.
constexpr std::size_t kMostParts = 16;

// Which voxels the runs of a batch lie in, numbered as they are met.
class VoxelGroups {
 public:
  std::uint16_t groupOf(std::int32_t x, std::int32_t y, std::int32_t z) {
    const std::uint32_t hash = static_cast<std::uint32_t>(x) * 0x9E3779B1U +
                               static_cast<std::uint32_t>(y) * 0x85EBCA77U +
                               static_cast<std::uint32_t>(z) * 0xC2B2AE3DU;
    std::size_t slot = (hash ^ (hash >> 15)) & kMask;
    while (slots_[slot] != 0) {
      const std::array<std::int32_t, 3>& voxel = voxels_[slots_[slot] - 1U];
      if (voxel[0] == x && voxel[1] == y && voxel[2] == z) return static_cast<std::uint16_t>(slots_[slot] - 1U);
      slot = (slot + 1) & kMask;
    }
    voxels_[count_] = {x, y, z};
    slots_[slot] = ++count_;
    return static_cast<std::uint16_t>(count_ - 1U);
  }
  std::uint16_t count() const { return count_; }

 private:
  static constexpr std::size_t kMask = 4 * kPointsPerBatch - 1;

  std::array<std::uint16_t, kMask + 1> slots_{};
  std::array<std::array<std::int32_t, 3>, kPointsPerBatch> voxels_;
  std::uint16_t count_ = 0;
};

void permute(float* values, const std::array<std::uint16_t, kPointsPerBatch>& from, std::size_t count) {
  std::array<float, kPointsPerBatch> permuted;
  for (std::size_t i = 0; i < count; ++i) permuted[i] = values[from[i]];
  std::copy_n(permuted.begin(), count, values);
}

}  // namespace

void OrderedSource::resize(std::size_t size) {
  size_ = size;
  for (std::vector<float>* values : {&x_, &y_, &z_, &confidence_, &non_ground_}) {
    values->resize(size + kRoomBehind);
    std::fill(values->end() - kRoomBehind, values->end(), 0.0F);
  }
  groups_of_batch_.assign((size + kPointsPerBatch - 1) / kPointsPerBatch, 0);
}

// A counting sort by columns, of parts of the points side by side: of a column, part after part.
void OrderedSource::order(const SourcePoints& source, double resolution_m, const ConfidenceOptions& confidence,
                          int threads) {
  resize(source.size());
  columns_.resize(size_);
  places_.assign(kParts * kColumnKeys, 0);
  const auto inverse_column_m = static_cast<float>(1.0 / (kVoxelsPerColumn * resolution_m));
  std::array<float, kStructuralLabelCount> confidence_of_label;
  for (int label = 0; label < kStructuralLabelCount; ++label) {
    confidence_of_label[label] = static_cast<float>(confidence.of(static_cast<StructuralLabel>(label)));
  }
  const auto begin_of = [this](std::size_t part) { return part * size_ / kParts; };
  std::array<std::size_t, kParts> non_ground_counts{};
  internal::forEachChunk(threads, kParts, [&](std::size_t part, int) {
    const std::size_t begin = begin_of(part), end = begin_of(part + 1);
    findColumns(source.x.data() + begin, source.y.data() + begin, end - begin, inverse_column_m,
                columns_.data() + begin);
    std::uint32_t* const counts = places_.data() + part * kColumnKeys;
    for (std::size_t i = begin; i < end; ++i) ++counts[columns_[i]];
  });
  std::uint32_t next = 0;
  for (std::size_t column = 0; column < kColumnKeys; ++column) {
    for (std::size_t part = 0; part < kParts; ++part) {
      std::uint32_t& place = places_[part * kColumnKeys + column];
      next += std::exchange(place, next);
    }
  }
  internal::forEachChunk(threads, kParts, [&](std::size_t part, int) {
    std::uint32_t* const places = places_.data() + part * kColumnKeys;
    std::size_t non_ground_count = 0;
    for (std::size_t i = begin_of(part); i < begin_of(part + 1); ++i) {
      const std::uint32_t place = places[columns_[i]]++;
      const bool non_ground = source.label[i] != static_cast<std::uint8_t>(StructuralLabel::GROUND);
      x_[place] = source.x[i];
      y_[place] = source.y[i];
      z_[place] = source.z[i];
      confidence_[place] = confidence_of_label[source.label[i]];
      non_ground_[place] = non_ground ? 1.0F : 0.0F;
      non_ground_count += non_ground ? 1 : 0;
    }
    non_ground_counts[part] = non_ground_count;
  });
  non_ground_count_ = std::accumulate(non_ground_counts.begin(), non_ground_counts.end(), std::size_t{0});
}

void OrderedSource::thin(const OrderedSource& source, std::size_t stride) {
  resize((source.size() + stride - 1) / stride);
  non_ground_count_ = 0;
  for (std::size_t i = 0; i < size_; ++i) {
    x_[i] = source.x_[i * stride];
    y_[i] = source.y_[i * stride];
    z_[i] = source.z_[i * stride];
    confidence_[i] = source.confidence_[i * stride];
    non_ground_[i] = source.non_ground_[i * stride];
    non_ground_count_ += non_ground_[i] > 0.0F ? 1 : 0;
  }
}

void OrderedSource::split(const std::vector<std::uint8_t>& marks, std::size_t count, int threads,
                          std::vector<OrderedSource>& parts) const {
  parts.resize(count);
  // Where each stretch of the points begins in each part.
  using Places = std::array<std::size_t, kMostParts>;
  std::array<Places, kParts> places;
  const auto begin_of = [this](std::size_t stretch) { return stretch * size_ / kParts; };
  Places sizes{};
  for (std::size_t stretch = 0; stretch < kParts; ++stretch) {
    places[stretch] = sizes;
    for (std::size_t i = begin_of(stretch); i < begin_of(stretch + 1); ++i) ++sizes[marks[i]];
  }
  for (std::size_t mark = 0; mark < count; ++mark) parts[mark].resize(sizes[mark]);
  forEachChunk(threads, kParts, [&](std::size_t stretch, int) {
    Places& next = places[stretch];
    for (std::size_t i = begin_of(stretch); i < begin_of(stretch + 1); ++i) {
      OrderedSource& part = parts[marks[i]];
      const std::size_t place = next[marks[i]]++;
      part.x_[place] = x_[i];
      part.y_[place] = y_[i];
      part.z_[place] = z_[i];
      part.confidence_[place] = confidence_[i];
      part.non_ground_[place] = non_ground_[i];
    }
  });
  for (OrderedSource& part : parts) {
    // They are in order as these points are.
    std::fill(part.groups_of_batch_.begin(), part.groups_of_batch_.end(), std::uint32_t{kPointsPerBatch});
    part.non_ground_count_ = static_cast<std::size_t>(
        std::count(part.non_ground_.begin(), part.non_ground_.begin() + static_cast<std::ptrdiff_t>(part.size_), 1.0F));
  }
}

bool OrderedSource::mixedUp(std::size_t first, std::size_t run_count) const {
  const std::uint32_t groups = groups_of_batch_[first / kPointsPerBatch];
  return groups == 0 || 2 * run_count > 3 * groups + 8;
}

void OrderedSource::regroup(std::size_t first, const BatchPoints& batch) {
  VoxelGroups groups;
  std::array<std::uint16_t, kPointsPerBatch> group_of_run;
  std::array<std::uint16_t, kPointsPerBatch> places{};
  for (std::size_t run = 0; run < batch.run_count; ++run) {
    const auto start = static_cast<std::size_t>(batch.run_starts[run]);
    const std::uint16_t group = groups.groupOf(batch.voxel[0][start], batch.voxel[1][start], batch.voxel[2][start]);
    group_of_run[run] = group;
    places[group] = static_cast<std::uint16_t>(places[group] + batch.run_starts[run + 1] - batch.run_starts[run]);
  }
  std::uint16_t begin = 0;
  for (std::size_t group = 0; group < groups.count(); ++group) {
    const std::uint16_t size = places[group];
    places[group] = begin;
    begin = static_cast<std::uint16_t>(begin + size);
  }
  std::array<std::uint16_t, kPointsPerBatch> from;
  for (std::size_t run = 0; run < batch.run_count; ++run) {
    for (auto i = batch.run_starts[run]; i < batch.run_starts[run + 1]; ++i) {
      from[places[group_of_run[run]]++] = static_cast<std::uint16_t>(i);
    }
  }
  const auto count = static_cast<std::size_t>(batch.run_starts[batch.run_count]);
  for (std::vector<float>* values : {&x_, &y_, &z_, &confidence_, &non_ground_})
    permute(values->data() + first, from, count);
  groups_of_batch_[first / kPointsPerBatch] = groups.count();
}

}  // namespace saw_ndt::internal
