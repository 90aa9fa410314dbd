#include "saw_ndt/map/weighted_map_builder.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "common/executor.h"
#include "common/no_return.h"
#include "map/map_file_writer.h"
#include "map/sums_statistics.h"
#include "map/tiled_entries.h"
#include "map/voxel_runs.h"
#include "map/voxel_sums_table.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/version.h"
#include "segmentation/segmentation_fields.h"

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

void requireSameSegmentation(const std::optional<SegmentationOptions>& into,
                             const std::optional<SegmentationOptions>& from) {
  if (into.has_value() != from.has_value()) {
    throw std::invalid_argument("segmentation: known of one of the maps to merge and not known of the other");
  }
  if (!into) return;
  if (const auto difference = firstDifference(*into, *from)) {
    throw std::invalid_argument("segmentation: the maps to merge differ in " + difference->field + ", which is " +
                                difference->first + " in one and " + difference->second + " in the other");
  }
}

// To be called before the sums are added; the order of additions does not matter. 0: not known of some of the points.
void addScanCount(const LabelledVoxelSums& from, LabelledVoxelSums& into) {
  if (into.sums.count == 0) {
    into.scan_count = from.scan_count;
  } else if (into.scan_count == 0 || from.scan_count == 0) {
    into.scan_count = 0;
  } else {
    const std::uint64_t scan_count = std::uint64_t{into.scan_count} + from.scan_count;
    into.scan_count = static_cast<std::uint32_t>(std::min<std::uint64_t>(scan_count, kMostScansOfVoxel));
  }
}

}  // namespace

WeightedMapBuilder::WeightedMapBuilder(double resolution_m, std::optional<SegmentationOptions> segmentation)
    : table_(std::make_unique<VoxelSumsTable>()) {
  origin_.resolution_m = resolution_m;
  origin_.segmentation = std::move(segmentation);
  origin_.software_version = SAW_NDT_VERSION;
  origin_.check();
}

WeightedMapBuilder::~WeightedMapBuilder() = default;
WeightedMapBuilder::WeightedMapBuilder(const WeightedMapBuilder& other)
    : origin_(other.origin_), table_(std::make_unique<VoxelSumsTable>(*other.table_)) {}
WeightedMapBuilder::WeightedMapBuilder(WeightedMapBuilder&& other) noexcept = default;
WeightedMapBuilder& WeightedMapBuilder::operator=(const WeightedMapBuilder& other) {
  return *this = WeightedMapBuilder(other);
}
WeightedMapBuilder& WeightedMapBuilder::operator=(WeightedMapBuilder&& other) noexcept = default;

bool WeightedMapBuilder::isEmpty() const { return origin_.scan_count == 0 && table_->size() == 0; }

void WeightedMapBuilder::requireKind(bool labelled) const {
  if (!isEmpty() && origin_.labelled != labelled) {
    throw std::invalid_argument("a map holds either labelled or unlabelled clouds, not both");
  }
}

void WeightedMapBuilder::beginAdding(bool labelled, const std::string& software_version) {
  if (isEmpty()) {
    origin_.labelled = labelled;
    origin_.software_version = software_version;
  } else if (origin_.software_version != software_version) {
    origin_.software_version.clear();
  }
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
  beginAdding(labels.known(), SAW_NDT_VERSION);
  ++origin_.scan_count;
  addPoints(points, labels, T_map_scan, threads);
}

void WeightedMapBuilder::continueScan(const ScanView& points, const LabelView& labels,
                                      const Eigen::Isometry3d& T_map_scan, int threads) {
  if (origin_.scan_count == 0) return addScan(points, labels, T_map_scan, threads);
  requireAddable(labels, T_map_scan);
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

void WeightedMapBuilder::merge(const WeightedMapBuilder& other) {
  EntryBatches batches;
  other.table_->forEachBatch([&](const std::vector<LabelledVoxelSums>& entries) { batches.push_back(&entries); });
  merge(other.origin_, batches);
}

void WeightedMapBuilder::merge(const WeightedVoxelMap& map) { merge(map.origin(), {&map.entries()}); }

void WeightedMapBuilder::merge(const MapOrigin& origin, const EntryBatches& batches) {
  checkOption(origin.resolution_m == origin_.resolution_m, "resolution_m", fieldText(origin.resolution_m),
              ("that of the map merged into, " + fieldText(origin_.resolution_m)).c_str());
  const bool adds = origin.scan_count != 0 ||
                    std::any_of(batches.begin(), batches.end(), [](const auto* entries) { return !entries->empty(); });
  if (adds) requireKind(origin.labelled);
  requireSameSegmentation(origin_.segmentation, origin.segmentation);
  if (!adds) return;
  requireRoomFor(origin, batches);
  beginAdding(origin.labelled, origin.software_version);
  for (const std::vector<LabelledVoxelSums>* const entries : batches) {
    table_->add(*entries,
                [](const LabelledVoxelSums& from, LabelledVoxelSums& into, std::size_t) { addScanCount(from, into); });
  }
  origin_.scan_count += origin.scan_count;
  origin_.point_count += origin.point_count;
}

void WeightedMapBuilder::requireRoomFor(const MapOrigin& origin, const EntryBatches& batches) const {
  if (origin.scan_count > std::numeric_limits<std::uint64_t>::max() - origin_.scan_count) {
    throw std::invalid_argument("scan_count: more scans than can be counted");
  }
  if (origin_.point_count + origin.point_count <= VoxelSums::kMostPoints) return;
  for (const std::vector<LabelledVoxelSums>* const entries : batches) {
    for (const LabelledVoxelSums& from : *entries) {
      const LabelledVoxelSums* const into = table_->find(from.voxel, from.label);
      if (into != nullptr && into->sums.count + from.sums.count > VoxelSums::kMostPoints) {
        throw std::invalid_argument("a voxel would hold more than 2^33 points");
      }
    }
  }
}

std::size_t WeightedMapBuilder::entryCount() const { return table_->size(); }

WeightedVoxelMap WeightedMapBuilder::build() const& {
  std::vector<LabelledVoxelSums> entries;
  entries.reserve(table_->size());
  table_->forEachBatch(
      [&](const std::vector<LabelledVoxelSums>& batch) { entries.insert(entries.end(), batch.begin(), batch.end()); });
  return {origin_, std::move(entries)};
}

WeightedVoxelMap WeightedMapBuilder::build() && {
  const MapOrigin origin = origin_;
  origin_.scan_count = origin_.point_count = 0;
  return {origin, table_->takeEntries()};
}

void WeightedMapBuilder::forEachTile(
    const std::function<void(const std::vector<LabelledVoxelSums>& entries)>& visit) const {
  const TiledEntries tiles(*table_);
  std::vector<LabelledVoxelSums> entries;
  for (std::size_t tile = 0; tile < tiles.tileCount(); ++tile) {
    tiles.read(tile, entries);
    visit(entries);
  }
}

void WeightedMapBuilder::save(const std::string& path) const {
  const TiledEntries tiles(*table_);
  MapFileWriter writer(path, origin_, tiles.tileCount());
  std::vector<LabelledVoxelSums> entries;
  for (std::size_t tile = 0; tile < tiles.tileCount(); ++tile) {
    tiles.read(tile, entries);
    writer.add(entries.data(), entries.data() + entries.size());
  }
  writer.commit(origin_.point_count);
}

std::size_t WeightedMapBuilder::voxelCount(const VoxelWeighting& weighting, int threads) const {
  weighting.check();
  const TiledEntries tiles(*table_);
  std::atomic<std::size_t> count{0};
  forEachChunk(threads, tiles.tileCount(), [&](std::size_t tile, int) {
    std::vector<LabelledVoxelSums> entries;
    tiles.read(tile, entries);
    forEachStatistics(entries.data(), entries.data() + entries.size(), weighting, {},
                      origin_.resolution_m / kStepsPerVoxel,
                      [&](const std::vector<VoxelStatistics>& batch) { count += batch.size(); });
  });
  return count;
}

}  // namespace saw_ndt
