#include "map/localization_map_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <utility>

#include "common/executor.h"
#include "map/level_plan.h"
#include "map/localization_map_layout.h"
#include "map/map_file_layout.h"
#include "map/map_metadata.h"
#include "map/resolution_range.h"
#include "map/weighting_fields.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/map/localization_map.h"

namespace saw_ndt {
namespace internal {

namespace {

constexpr std::size_t kMagicBytes = sizeof kLocalizationMapMagic - 1;

std::vector<double> resolutionsOf(const TargetPlan& plan) {
  std::vector<double> resolutions_m;
  for (const LevelPlan& level : plan.levels) resolutions_m.push_back(level.resolution_m);
  if (plan.coarse) resolutions_m.push_back(plan.coarse->resolution_m);
  return resolutions_m;
}

}  // namespace

LocalizationMapFile::LocalizationMapFile(const std::string& path) : path_(path), file_(path) { readHeader(); }

void LocalizationMapFile::readHeader() {
  if (file_.size() < kMagicBytes || std::memcmp(file_.data(), kLocalizationMapMagic, kMagicBytes) != 0) {
    fail(0, "not a saw_ndt localization map");
  }
  LocalizationMapHeader header;
  if (file_.size() < sizeof header)
    fail(file_.size(), "truncated: the header has " + std::to_string(sizeof header) + " bytes");
  std::memcpy(&header, file_.data(), sizeof header);
  if (header.version.value() != kLocalizationMapVersion) {
    fail(offsetof(LocalizationMapHeader, version),
         "localization map version " + std::to_string(header.version.value()) + ", this program reads version " +
             std::to_string(kLocalizationMapVersion));
  }
  if (header.checksum.value() != checksumOf(&header, offsetof(LocalizationMapHeader, checksum))) {
    fail(offsetof(LocalizationMapHeader, checksum), "damaged: the header's checksum does not match");
  }
  if (header.file_bytes.value() != file_.size()) {
    fail(file_.size(), "truncated or damaged: " + std::to_string(header.file_bytes.value()) + " bytes expected");
  }
  if (header.header_bytes.value() != sizeof header || header.tile_m.value() != kLocalizationTile_m ||
      header.labelled.value() > 1) {
    fail(offsetof(LocalizationMapHeader, header_bytes), "damaged: the header states an unknown layout");
  }
  origin_.resolution_m = header.resolution_m.value();
  if (!isResolution(origin_.resolution_m)) {
    fail(offsetof(LocalizationMapHeader, resolution_m), "damaged: the resolution is not that of a map");
  }
  origin_.labelled = header.labelled.value() == 1;
  origin_.scan_count = header.scan_count.value();
  origin_.point_count = header.point_count.value();
  voxel_count_ = header.voxel_count.value();
  coarse_voxel_count_ = header.coarse_voxel_count.value();
  directory_offset_ = header.directory_offset.value();
  tiles_offset_ = sizeof header + std::uint64_t{header.metadata_bytes.value()};
  const std::uint64_t tile_count = header.tile_count.value();
  if (tiles_offset_ > file_.size() || directory_offset_ < tiles_offset_ || directory_offset_ > file_.size() ||
      tile_count != (file_.size() - directory_offset_) / sizeof(LocalizationTileRecord) ||
      (file_.size() - directory_offset_) % sizeof(LocalizationTileRecord) != 0) {
    fail(offsetof(LocalizationMapHeader, directory_offset), "damaged: the header states an impossible layout");
  }
  tile_count_ = static_cast<std::size_t>(tile_count);
  for (int axis = 0; axis < 2; ++axis) {
    least_m_[axis] = header.least_m[axis].value();
    greatest_m_[axis] = header.greatest_m[axis].value();
    if (!(std::abs(least_m_[axis]) <= kFarthestTile_m) || !(std::abs(greatest_m_[axis]) <= kFarthestTile_m)) {
      fail(offsetof(LocalizationMapHeader, least_m), "damaged: the header states an impossible extent");
    }
  }
  readMetadata(header.metadata_bytes.value(), header.metadata_checksum.value());
  resolutions_m_ = resolutionsOf(planTarget(origin_, weighting_));
}

void LocalizationMapFile::readMetadata(std::uint32_t size, std::uint32_t checksum) {
  constexpr std::uint64_t kOffset = sizeof(LocalizationMapHeader);
  const std::string_view text(file_.data() + kOffset, size);
  if (checksumOf(text.data(), text.size()) != checksum) {
    fail(kOffset, "damaged: the metadata's checksum does not match");
  }
  if (const auto fault = internal::readMetadata(text, origin_)) fail(kOffset + fault->offset, fault->reason);
  if (const auto fault = readWeighting(text, weighting_)) fail(kOffset + fault->offset, fault->reason);
}

LocalizationTilePlace LocalizationMapFile::tile(std::size_t number) const {
  const std::uint64_t record_offset = directory_offset_ + number * sizeof(LocalizationTileRecord);
  LocalizationTileRecord record;
  std::memcpy(&record, file_.data() + record_offset, sizeof record);
  if (record.checksum.value() != checksumOf(&record, offsetof(LocalizationTileRecord, checksum))) {
    fail(record_offset, "damaged: the checksum of a tile's record does not match");
  }
  LocalizationTilePlace place;
  place.at = {record.x.value(), record.y.value()};
  place.offset = record.offset.value();
  place.cell_bytes = record.cell_bytes.value();
  place.cell_checksum = record.cell_checksum.value();
  place.table_bytes = record.table_bytes.value();
  place.table_checksum = record.table_checksum.value();
  place.voxel_count = record.voxel_count.value();
  const std::uint64_t bytes = std::uint64_t{place.cell_bytes} + place.table_bytes;
  if (place.offset < tiles_offset_ || place.offset > directory_offset_ || bytes > directory_offset_ - place.offset) {
    fail(record_offset, "damaged: a tile lies outside of the file");
  }
  if (!isWithinReach(place.at, origin_.resolution_m)) {
    fail(record_offset, "damaged: a tile lies too far out");
  }
  return place;
}

std::size_t LocalizationMapFile::firstFrom(const TileCoordinate& at) const {
  std::size_t first = 0, last = tile_count_;
  while (first < last) {
    const std::size_t middle = first + (last - first) / 2;
    if (tile(middle).at < at) {
      first = middle + 1;
    } else {
      last = middle;
    }
  }
  return first;
}

std::vector<LocalizationTilePlace> LocalizationMapFile::tilesAround(const Eigen::Vector2d& position_m,
                                                                    double radius_m) const {
  std::vector<LocalizationTilePlace> tiles;
  const auto clamped = [&](const Eigen::Vector2d& corner) -> Eigen::Vector2d {
    return corner.cwiseMax(least_m_).cwiseMin(greatest_m_);
  };
  if (tile_count_ == 0 || !position_m.allFinite() || !(radius_m >= 0.0)) return tiles;
  const Eigen::Vector2d radius(radius_m, radius_m);
  const Eigen::Vector2d least_m = clamped(position_m - radius), greatest_m = clamped(position_m + radius);
  const TileCoordinate least = localizationTileAt(least_m.x(), least_m.y());
  const TileCoordinate greatest = localizationTileAt(greatest_m.x(), greatest_m.y());
  // Rows without tiles are not visited, so that the work is bounded by the tiles that there are.
  const auto firstBehind = [&](std::size_t number, const TileCoordinate& at) {
    const std::size_t first = firstFrom(at);
    if (first < number) failOutOfOrder(first);
    return first;
  };
  for (std::size_t number = firstFrom(least); number < tile_count_;) {
    const int y = tile(number).at.y;
    if (y > greatest.y) break;
    std::size_t in_row = firstBehind(number, {least.x, y});
    for (; in_row < tile_count_; ++in_row) {
      const LocalizationTilePlace place = tile(in_row);
      if (place.at.y != y || place.at.x > greatest.x) break;
      const Eigen::Vector2d corner_m = kLocalizationTile_m * Eigen::Vector2d(place.at.x, place.at.y);
      const Eigen::Vector2d nearest_m =
          position_m.cwiseMax(corner_m).cwiseMin(corner_m + Eigen::Vector2d::Constant(kLocalizationTile_m));
      if ((nearest_m - position_m).norm() <= radius_m) tiles.push_back(place);
    }
    number = firstBehind(std::max(in_row, number + 1), {least.x, y + 1});
  }
  requireDisjoint(tiles);
  return tiles;
}

std::vector<LocalizationTilePlace> LocalizationMapFile::allTiles() const {
  std::vector<LocalizationTilePlace> tiles;
  tiles.reserve(tile_count_);
  for (std::size_t number = 0; number < tile_count_; ++number) {
    tiles.push_back(tile(number));
    if (number > 0 && !(tiles[number - 1].at < tiles[number].at)) failOutOfOrder(number);
  }
  requireDisjoint(tiles);
  return tiles;
}

void LocalizationMapFile::failOutOfOrder(std::size_t number) const {
  fail(directory_offset_ + number * sizeof(LocalizationTileRecord), "damaged: a tile is out of order");
}

// Tiles that share bytes would need memory far beyond the size of the file.
void LocalizationMapFile::requireDisjoint(const std::vector<LocalizationTilePlace>& tiles) const {
  std::uint64_t bytes = 0;
  for (const LocalizationTilePlace& tile : tiles) bytes += std::uint64_t{tile.cell_bytes} + tile.table_bytes;
  if (bytes > directory_offset_ - tiles_offset_) fail(directory_offset_, "damaged: tiles overlap");
}

void LocalizationMapFile::decode(const LocalizationTilePlace& tile, const LocalizationClip& clip,
                                 std::vector<NdtCells>& cells) const {
  const std::string_view bytes = this->cells(tile);
  requireCells(appendDecodedTile(bytes.data(), bytes.size(), tile.at, resolutions_m_, weighting_, clip, cells), tile);
  file_.forget(tile.offset, tile.cell_bytes);
}

NdtTarget LocalizationMapFile::targetOf(const std::vector<LocalizationTilePlace>& tiles, int threads,
                                        const LocalizationClip& clip) const {
  // Few parts, for each is copied once more.
  const std::size_t part_count =
      std::clamp<std::size_t>(tiles.size(), 1, static_cast<std::size_t>(threadCount(threads)));
  std::vector<std::vector<NdtCells>> parts(part_count, std::vector<NdtCells>(resolutions_m_.size()));
  forEachChunk(threads, part_count, [&](std::size_t part, int) {
    for (std::size_t i = tiles.size() * part / part_count; i < tiles.size() * (part + 1) / part_count; ++i) {
      decode(tiles[i], clip, parts[part]);
    }
  });
  std::vector<NdtLevel> levels(resolutions_m_.size());
  forEachChunk(threads, levels.size(), [&](std::size_t level, int) {
    NdtCells cells;
    for (std::vector<NdtCells>& part : parts) cells.append(std::exchange(part[level], {}));
    levels[level] = NdtLevel(resolutions_m_[level], std::move(cells));
  });
  return NdtTarget::ofLevels(origin_, weighting_, std::move(levels));
}

void LocalizationMapFile::requireCells(bool are_valid, const LocalizationTilePlace& tile) const {
  if (!are_valid) fail(tile.offset, "damaged: a tile has voxels that cannot be");
}

void LocalizationMapFile::forEachCellOf(
    const LocalizationTilePlace& tile,
    const std::function<void(std::size_t level, const QuantizedCell& cell)>& visit) const {
  const std::string_view bytes = cells(tile);
  requireCells(forEachCell(bytes.data(), bytes.size(), tile.at, resolutions_m_, visit), tile);
  file_.forget(tile.offset, tile.cell_bytes);
}

std::string_view LocalizationMapFile::cells(const LocalizationTilePlace& tile) const {
  const std::string_view cells(file_.data() + tile.offset, tile.cell_bytes);
  if (checksumOf(cells.data(), cells.size()) != tile.cell_checksum) {
    fail(tile.offset, "damaged: the checksum of a tile does not match");
  }
  return cells;
}

std::string_view LocalizationMapFile::searchTable(const LocalizationTilePlace& tile) const {
  const std::uint64_t offset = tile.offset + tile.cell_bytes;
  const std::string_view table(file_.data() + offset, tile.table_bytes);
  if (checksumOf(table.data(), table.size()) != tile.table_checksum) {
    fail(offset, "damaged: the checksum of a search table does not match");
  }
  return table;
}

}  // namespace internal

LocalizationMap::LocalizationMap(const std::string& path)
    : file_(std::make_shared<const internal::LocalizationMapFile>(path)) {}

void LocalizationMap::requireWeighting(const VoxelWeighting& weighting) const {
  if (this->weighting() == weighting) return;
  throw Error(path(), "",
              "is a localization map that was packed for other voxels and weights than this method's: pack the "
              "statistics map for it, or use that");
}

bool LocalizationMap::isOne(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return false;  // to open a pipe may wait forever
  std::ifstream stream(path, std::ios::binary);
  char magic[internal::kMagicBytes];
  return stream.read(magic, sizeof magic) && std::memcmp(magic, internal::kLocalizationMapMagic, sizeof magic) == 0;
}

const std::string& LocalizationMap::path() const { return file_->path(); }
const MapOrigin& LocalizationMap::origin() const { return file_->origin(); }
const VoxelWeighting& LocalizationMap::weighting() const { return file_->weighting(); }
std::uint64_t LocalizationMap::voxelCount() const { return file_->voxelCount(); }
std::uint64_t LocalizationMap::coarseVoxelCount() const { return file_->coarseVoxelCount(); }
std::uint64_t LocalizationMap::tileCount() const { return file_->tileCount(); }
std::uint64_t LocalizationMap::fileSize() const { return file_->size(); }

NdtTarget LocalizationMap::target(int threads) const { return file_->targetOf(file_->allTiles(), threads); }

NdtTarget LocalizationMap::targetAround(const Eigen::Vector3d& position_m, double radius_m, int threads) const {
  return file_->targetOf(file_->tilesAround(position_m.head<2>(), radius_m), threads, {position_m.head<2>(), radius_m});
}

}  // namespace saw_ndt
