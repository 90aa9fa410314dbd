#include "map/map_file.h"

#include <algorithm>
#include <cstring>

#include "map/map_encoding.h"
#include "map/map_file_layout.h"

namespace saw_ndt::internal {
namespace {

constexpr std::size_t kEntryBytes = sizeof(MapEntryLayout);
constexpr std::uint64_t kMostEntriesPerPart = 8192;
constexpr std::uint64_t kLeastBytesPerPiece = std::uint64_t{4} << 20U;

MapEntryLayout entryAt(const char* bytes, std::uint64_t i) {
  MapEntryLayout layout;
  std::memcpy(&layout, bytes + i * kEntryBytes, kEntryBytes);
  return layout;
}

// Whether points of a voxel can have these sums: none lies further than half a voxel from its centre. Keeps a file that
// was made to mislead from overflowing what is computed with them.
bool canBeSums(const VoxelSums& sums) {
  constexpr std::uint64_t kHalf = kStepsPerVoxel / 2;
  if (sums.count == 0 || sums.count > VoxelSums::kMostPoints) return false;
  const auto within = [](std::int64_t value, std::uint64_t limit) {
    const auto bits = static_cast<std::uint64_t>(value);
    return (value < 0 ? std::uint64_t{0} - bits : bits) <= limit;
  };
  for (const std::int64_t value : sums.sum) {
    if (!within(value, sums.count * kHalf)) return false;
  }
  for (const std::int64_t value : sums.product) {
    if (!within(value, sums.count * kHalf * kHalf)) return false;
  }
  return true;
}

bool decoded(const MapEntryLayout& layout, const Eigen::Vector3i& tile, LabelledVoxelSums& entry) {
  bool valid = layout.label < kStructuralLabelCount;
  for (int axis = 0; axis < 3; ++axis) valid = valid && layout.place[axis] < kTileSize;
  entry = decodeEntry(layout, tile);
  return valid && canBeSums(entry.sums);
}

}  // namespace

MapFileReader::MapFileReader(const std::string& path) : path_(path), file_(openMapFile(path)), front_(path, file_) {}

std::string MapFileReader::header() const { return {file_.data(), sizeof(MapHeaderLayout)}; }

bool MapFileReader::readPiece(MapPiece& piece) {
  for (const MapPart& part : piece.parts) file_.forget(part.offset, part.entry_count * kEntryBytes);
  piece.parts.clear();
  for (std::uint64_t bytes = 0; bytes < kLeastBytesPerPiece;) {
    while (next_tile_ < tileCount() && front_.tile(next_tile_).entry_count == 0) ++next_tile_;
    if (next_tile_ == tileCount()) break;
    const MapPart part = nextPart();
    if (!part.whole_tile) continueTile(part);
    entries_of_tile_read_ += part.entry_count;
    bytes += part.entry_count * kEntryBytes;
    if (entries_of_tile_read_ == front_.tile(next_tile_).entry_count) {
      entries_of_tile_read_ = 0;
      ++next_tile_;
    }
    piece.parts.push_back(part);
  }
  if (piece.parts.empty()) checkEnd();
  return !piece.parts.empty();
}

MapPart MapFileReader::nextPart() const {
  const MapTileRecord tile = front_.tile(next_tile_);
  const std::uint64_t left = tile.entry_count - entries_of_tile_read_;
  MapPart part;
  part.tile = next_tile_;
  part.offset = tile.offset + entries_of_tile_read_ * kEntryBytes;
  part.entry_count = std::min(left, kMostEntriesPerPart);
  part.whole_tile = part.entry_count == tile.entry_count;
  if (part.entry_count == left) return part;
  // The last voxel may go on behind the part: it is left to the next one.
  const char* const bytes = file_.data() + part.offset;
  const std::uint32_t last = entryAt(bytes, part.entry_count - 1).order() >> 8U;
  while (part.entry_count > 0 && entryAt(bytes, part.entry_count - 1).order() >> 8U == last) --part.entry_count;
  if (part.entry_count == 0) fail(part.offset, "damaged: a voxel has more labels than there are");
  return part;
}

// Checks what no part of a tile can tell alone.
void MapFileReader::continueTile(const MapPart& part) {
  const MapTileRecord tile = front_.tile(part.tile);
  const char* const bytes = file_.data() + part.offset;
  const bool first = entries_of_tile_read_ == 0;
  checksum_of_tile_ = checksumOf(bytes, part.entry_count * kEntryBytes, first ? 0 : checksum_of_tile_);
  if (!first && entryAt(bytes, 0).order() <= last_place_in_tile_) {
    fail(part.offset, "damaged: an entry is out of range or out of order");
  }
  last_place_in_tile_ = entryAt(bytes, part.entry_count - 1).order();
  if (entries_of_tile_read_ + part.entry_count == tile.entry_count && checksum_of_tile_ != tile.checksum) {
    fail(tile.offset, "damaged: the checksum of a tile does not match");
  }
}

void MapFileReader::decode(const MapPart& part, std::vector<LabelledVoxelSums>& entries) {
  const MapTileRecord tile = front_.tile(part.tile);
  const char* const bytes = file_.data() + part.offset;
  if (part.whole_tile && checksumOf(bytes, part.entry_count * kEntryBytes) != tile.checksum) {
    fail(part.offset, "damaged: the checksum of a tile does not match");
  }
  entries.resize(part.entry_count);
  const std::uint64_t most_scans = front_.version() < kFirstVersionWithScans ? 0 : origin().scan_count;
  std::uint64_t points = 0;
  std::uint32_t before = 0;
  for (std::size_t i = 0; i < part.entry_count; ++i) {
    const MapEntryLayout layout = entryAt(bytes, i);
    if (!decoded(layout, tile.coordinate, entries[i]) || entries[i].sums.count > origin().point_count ||
        entries[i].scan_count > most_scans || (i > 0 && layout.order() <= before)) {
      fail(part.offset + i * kEntryBytes, "damaged: an entry is out of range or out of order");
    }
    before = layout.order();
    points += entries[i].sums.count;
  }
  points_ += points;
}

void MapFileReader::decodeTile(std::uint64_t tile, std::vector<LabelledVoxelSums>& entries) {
  const MapTileRecord record = front_.tile(tile);
  decode({tile, true, record.offset, record.entry_count}, entries);
}

VoxelCoordinate MapFileReader::voxelOf(const MapTileRecord& tile, std::uint64_t entry) const {
  const MapEntryLayout layout = entryAt(bytesOf(tile), entry);
  return tile.coordinate * kTileSize + VoxelCoordinate(layout.place[0], layout.place[1], layout.place[2]);
}

void MapFileReader::forget(const MapTileRecord& tile) const {
  file_.forget(tile.offset, tile.entry_count * kEntryBytes);
}

void MapFileReader::checkEnd() const {
  if (points_ != origin().point_count) {
    fail(front_.offsetOfRecord(0), "damaged: the entries and the header disagree on the number of points");
  }
}

}  // namespace saw_ndt::internal
