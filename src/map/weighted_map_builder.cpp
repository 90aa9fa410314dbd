#include "saw_ndt/map/weighted_map_builder.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "common/executor.h"
#include "common/no_return.h"
#include "map/map_encoding.h"
#include "map/map_file_writer.h"
#include "map/merge_rules.h"
#include "map/spilled_tiles.h"
#include "map/sums_statistics.h"
#include "map/tiled_entries.h"
#include "map/voxel_runs.h"
#include "map/voxel_sums_table.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/version.h"

namespace saw_ndt {
namespace {
using namespace internal;

// Fewer points are not worth another thread's table.
constexpr std::size_t kMinPointsPerThread = 20000;

PointPlacement placementOf(const Eigen::Isometry3d& T_map_points, double resolution_m) {
  PointPlacement placement;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) placement.T_map_points[row][column] = T_map_points(row, column);
  }
  placement.in_map_frame = T_map_points.matrix() == Eigen::Matrix4d::Identity();
  placement.inverse_resolution = 1.0 / resolution_m;
  return placement;
}

// Adds points `first` to `last` of the scan of a number to a table; returns how many of them have a voxel.
std::uint64_t addRange(const ScanView& points, const LabelView& labels, std::size_t first, std::size_t last,
                       const PointPlacement& placement, std::uint32_t scan, VoxelSumsTable& table) {
  const auto block = std::make_unique<PointBlock>();
  block->stride = points.stride;
  std::uint64_t count = 0;
  for (std::size_t i = first; i < last; i += block->size) {
    block->xyz = points.point(i);
    block->size = std::min(last - i, PointBlock::kMostPoints);
    if (!labels.known()) {
      std::fill_n(block->label, block->size, static_cast<std::int32_t>(StructuralLabel::NON_GROUND));
    } else {
      for (std::size_t k = 0; k < block->size; ++k) {
        block->label[k] = labels.first[(i + k) * labels.stride];
      }
    }
    for (std::size_t k = 0; k < block->size; ++k) {
      block->label[k] = isReturn(points.point(i + k)) ? block->label[k] : kNoVoxel;
    }
    const std::size_t run_count = findVoxelRuns(placement, *block);
    std::size_t point = 0;
    for (std::size_t k = 0; k < run_count; ++k) {
      const VoxelRun& run = block->runs[k];
      const auto run_size = static_cast<std::size_t>(run.sum_count[3]);
      if (block->label[point] != kNoVoxel) {
        const VoxelCoordinate voxel(block->voxel[0][point], block->voxel[1][point], block->voxel[2][point]);
        const std::size_t place = table.placeOf(voxel, static_cast<StructuralLabel>(block->label[point]));
        table.meet(place, scan);
        VoxelSums& sums = table.entry(place).sums;
        sums.count += run_size;
        for (std::size_t j = 0; j < 3; ++j) sums.sum[j] += run.sum_count[j];
        for (std::size_t j = 0; j < 6; ++j) sums.product[j] += run.product[j];
        count += run_size;
      }
      point += run_size;
    }
  }
  return count;
}

// Throws std::invalid_argument where a label of a scan is none.
void requireLabels(const LabelView& labels, std::size_t points) {
  if (!labels.known()) return;
  std::uint8_t greatest = 0;
  for (std::size_t i = 0; i < points; ++i) greatest = std::max(greatest, labels.first[i * labels.stride]);
  structuralLabelFromValue(greatest);
}

}  // namespace

WeightedMapBuilder::WeightedMapBuilder(double resolution_m, std::optional<SegmentationOptions> segmentation)
    : table_(std::make_unique<VoxelSumsTable>()) {
  origin_.resolution_m = resolution_m;
  origin_.segmentation = std::move(segmentation);
  origin_.software_version = SAW_NDT_VERSION;
  origin_.check();
}

void WeightedMapBuilder::setMapOrigin(const Eigen::Vector3d& map_origin_m) {
  MapOrigin origin = origin_;
  origin.map_origin_m = map_origin_m;
  origin.check();
  origin_ = origin;
}

WeightedMapBuilder::~WeightedMapBuilder() = default;
WeightedMapBuilder::WeightedMapBuilder(const WeightedMapBuilder& other)
    : origin_(other.origin_),
      table_(std::make_unique<VoxelSumsTable>(*other.table_)),
      most_entries_(other.most_entries_),
      spilled_(other.spilled_ ? std::make_unique<SpilledTiles>(*other.spilled_) : nullptr) {}
WeightedMapBuilder::WeightedMapBuilder(WeightedMapBuilder&& other) noexcept = default;
WeightedMapBuilder& WeightedMapBuilder::operator=(const WeightedMapBuilder& other) {
  return *this = WeightedMapBuilder(other);
}
WeightedMapBuilder& WeightedMapBuilder::operator=(WeightedMapBuilder&& other) noexcept = default;

bool WeightedMapBuilder::isEmpty() const { return origin_.scan_count == 0 && table_->size() == 0 && !hasSpilled(); }

void WeightedMapBuilder::requireKind(bool labelled) const {
  if (!isEmpty() && origin_.labelled != labelled) {
    throw std::invalid_argument("a map holds either labelled or unlabelled clouds, not both");
  }
}

void WeightedMapBuilder::beginAdding(bool labelled, const std::string& software_version) {
  internal::beginAdding(origin_, !isEmpty(), labelled, software_version);
}

void WeightedMapBuilder::requireAddable(const LabelView& labels, const Eigen::Isometry3d& T_map_scan) const {
  if (!T_map_scan.matrix().allFinite()) throw std::invalid_argument("T_map_scan is not finite");
  if (!labels.known() && origin_.segmentation) {
    throw std::invalid_argument("the segmentation of the scans has been given, but a scan has no labels");
  }
  requireKind(labels.known());
}

void WeightedMapBuilder::addScan(const ScanView& points, const LabelView& labels, const Eigen::Isometry3d& T_map_scan,
                                 int threads) {
  requireAddable(labels, T_map_scan);
  requireLabels(labels, points.size);
  beginAdding(labels.known(), SAW_NDT_VERSION);
  ++origin_.scan_count;
  // Not while a scan may be continued: a voxel counts it once.
  spillWhereTooMany();
  addPoints(points, labels, T_map_scan, threads);
}

void WeightedMapBuilder::continueScan(const ScanView& points, const LabelView& labels,
                                      const Eigen::Isometry3d& T_map_scan, int threads) {
  if (origin_.scan_count == 0) return addScan(points, labels, T_map_scan, threads);
  requireAddable(labels, T_map_scan);
  requireLabels(labels, points.size);
  beginAdding(labels.known(), SAW_NDT_VERSION);
  addPoints(points, labels, T_map_scan, threads);
}

void WeightedMapBuilder::addPoints(const ScanView& points, const LabelView& labels, const Eigen::Isometry3d& T_map_scan,
                                   int threads) {
  const auto scan = static_cast<std::uint32_t>(origin_.scan_count);
  const PointPlacement placement = placementOf(T_map_scan, origin_.resolution_m);
  const std::size_t most_parts = std::max<std::size_t>(1, points.size / kMinPointsPerThread);
  const int part_count =
      static_cast<int>(std::min<std::size_t>(static_cast<std::size_t>(internal::threadCount(threads)), most_parts));
  if (part_count == 1) {
    origin_.point_count += addRange(points, labels, 0, points.size, placement, scan, *table_);
    return;
  }
  struct Part {
    VoxelSumsTable table;
    std::uint64_t point_count = 0;
  };
  std::vector<Part> parts(static_cast<std::size_t>(part_count));
  forEachChunk(threads, parts.size(), [&](std::size_t p, int) {
    const auto start = [&](std::size_t number) { return points.size * number / parts.size(); };
    parts[p].point_count = addRange(points, labels, start(p), start(p + 1), placement, scan, parts[p].table);
  });
  for (const Part& part : parts) {
    table_->add(part.table, [&](const LabelledVoxelSums&, const LabelledVoxelSums&, std::size_t place) {
      table_->meet(place, scan);
    });
    origin_.point_count += part.point_count;
  }
}

void WeightedMapBuilder::limitMemory(std::size_t most_entries, const std::filesystem::path& folder) {
  checkOption(most_entries > 0, "most_entries", most_entries, "1 or more");
  if (spilled_ == nullptr) spilled_ = std::make_unique<SpilledTiles>(folder);
  most_entries_ = most_entries;
}

bool WeightedMapBuilder::hasSpilled() const { return spilled_ != nullptr && !spilled_->parts().empty(); }

void WeightedMapBuilder::spillWhereTooMany() {
  if (spilled_ == nullptr || table_->size() < most_entries_) return;
  forEachTileOf(*table_, nullptr, [&](const std::vector<LabelledVoxelSums>& entries) { spilled_->add(entries); });
  table_->clear();
}

void WeightedMapBuilder::merge(const WeightedMapBuilder& other) {
  const bool adds = !other.isEmpty();
  requireMergeable(origin_, !isEmpty(), other.origin_, adds);
  if (!adds) return;
  if (!other.hasSpilled()) {
    other.table_->forEachBatch(
        [&](const std::vector<LabelledVoxelSums>& entries) { requireRoomFor(other.origin_, entries); });
  }
  const bool holds = !isEmpty();
  if (other.hasSpilled()) {
    other.forEachTile([&](const std::vector<LabelledVoxelSums>& entries) { add(entries); });
  } else {
    other.table_->forEachBatch([&](const std::vector<LabelledVoxelSums>& entries) { add(entries); });
  }
  addOrigin(origin_, holds, other.origin_);
}

void WeightedMapBuilder::merge(const WeightedVoxelMap& map) {
  const bool adds = map.origin().scan_count != 0 || !map.entries().empty();
  requireMergeable(origin_, !isEmpty(), map.origin(), adds);
  if (!adds) return;
  requireRoomFor(map.origin(), map.entries());
  const bool holds = !isEmpty();
  add(map.entries());
  addOrigin(origin_, holds, map.origin());
}

void WeightedMapBuilder::add(const std::vector<LabelledVoxelSums>& entries) {
  spillWhereTooMany();
  table_->add(entries,
              [](const LabelledVoxelSums& from, LabelledVoxelSums& into, std::size_t) { addScanCount(from, into); });
}

void WeightedMapBuilder::requireRoomFor(const MapOrigin& origin, const std::vector<LabelledVoxelSums>& entries) const {
  if (origin_.point_count + origin.point_count <= VoxelSums::kMostPoints) return;
  for (const LabelledVoxelSums& from : entries) {
    const LabelledVoxelSums* const into = table_->find(from.voxel, from.label);
    if (into != nullptr) internal::requireRoomFor(from.sums, into->sums);
  }
}

std::size_t WeightedMapBuilder::entryCount() const { return table_->size(); }

WeightedVoxelMap WeightedMapBuilder::build() const& {
  std::vector<LabelledVoxelSums> entries;
  if (hasSpilled()) {
    forEachTile(
        [&](const std::vector<LabelledVoxelSums>& tile) { entries.insert(entries.end(), tile.begin(), tile.end()); });
  } else {
    entries.reserve(table_->size());
    table_->forEachBatch([&](const std::vector<LabelledVoxelSums>& batch) {
      entries.insert(entries.end(), batch.begin(), batch.end());
    });
  }
  return {origin_, std::move(entries)};
}

WeightedVoxelMap WeightedMapBuilder::build() && {
  if (hasSpilled()) {
    WeightedVoxelMap map = static_cast<const WeightedMapBuilder&>(*this).build();
    table_->clear();
    spilled_->clear();
    origin_.scan_count = origin_.point_count = 0;
    return map;
  }
  const MapOrigin origin = origin_;
  origin_.scan_count = origin_.point_count = 0;
  return {origin, table_->takeEntries()};
}

void WeightedMapBuilder::forEachTile(const std::function<void(const std::vector<LabelledVoxelSums>& entries)>& visit,
                                     int threads) const {
  forEachTileOf(*table_, spilled_.get(), visit, threads);
}

WrittenMap WeightedMapBuilder::save(const std::string& path, int threads) const {
  struct Encoded {
    MapTileRecord record;
    std::vector<char> bytes;
    std::uint64_t voxel_count = 0;
  };
  const TiledEntries tiles(*table_, spilled_.get());
  MapFileWriter writer(path, origin_, tiles.tileCount());
  WrittenMap written;
  tiles.forEach<Encoded>(
      threads,
      [&](const std::vector<LabelledVoxelSums>& entries, Encoded& encoded) {
        const LabelledVoxelSums* const end = entries.data() + entries.size();
        encoded.record = encodeTile(entries.data(), end, encoded.bytes);
        encoded.voxel_count = voxelCountOf(entries.data(), end, origin_.resolution_m);
      },
      [&](const Encoded& encoded) {
        writer.add(encoded.record, encoded.bytes);
        written.voxel_count += encoded.voxel_count;
        written.entry_count += encoded.record.entry_count;
      });
  writer.commit(origin_.point_count);
  written.origin = origin_;
  written.tile_count = tiles.tileCount();
  written.file_bytes = writer.size();
  return written;
}

}  // namespace saw_ndt
