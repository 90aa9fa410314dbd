#include "map/map_file.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "map/map_file_layout.h"
#include "map/map_metadata.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {
namespace {

constexpr std::size_t kEntryBytes = sizeof(MapEntryLayout);
constexpr std::uint64_t kMostEntriesPerPart = 8192;
constexpr std::uint64_t kMostBytesPerPiece = std::uint64_t{4} << 20U;

MapEntryLayout entryAt(const MapPart& part, std::size_t i) {
  MapEntryLayout layout;
  std::memcpy(&layout, part.bytes + i * kEntryBytes, kEntryBytes);
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
  for (int axis = 0; axis < 3; ++axis) {
    valid = valid && layout.place[axis] < kTileSize;
    entry.voxel[axis] = tile[axis] * kTileSize + layout.place[axis];
  }
  entry.label = static_cast<StructuralLabel>(layout.label);
  entry.sums.count = layout.count.value();
  entry.scan_count = layout.scan_count.value();
  for (std::size_t i = 0; i < entry.sums.sum.size(); ++i) entry.sums.sum[i] = layout.sum[i].value();
  for (std::size_t i = 0; i < entry.sums.product.size(); ++i) entry.sums.product[i] = layout.product[i].value();
  return valid && canBeSums(entry.sums);
}

}  // namespace

MapFileReader::MapFileReader(const std::string& path) : path_(path), stream_(path, std::ios::binary) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) throw Error(path, "", "is a folder, not a map file");
  if (!stream_) throw Error(path, "", std::string("cannot be opened: ") + std::strerror(errno));
  size_ = std::filesystem::file_size(path, error);
  if (error) throw Error(path, "", error.message());
  readMagicAndVersion();
  readHeader();
}

void MapFileReader::fail(std::uint64_t offset, const std::string& reason) const {
  throw Error(path_, "offset " + std::to_string(offset), reason);
}

void MapFileReader::read(std::uint64_t offset, std::size_t count, std::vector<char>& bytes) {
  if (offset > size_ || count > size_ - offset) {
    fail(size_, "truncated: " + std::to_string(offset + count) + " bytes expected");
  }
  bytes.resize(count);
  stream_.seekg(static_cast<std::streamoff>(offset));
  if (!stream_.read(bytes.data(), static_cast<std::streamsize>(count))) fail(offset, "cannot be read");
}

template <typename Layout>
Layout MapFileReader::read(std::uint64_t offset) {
  std::vector<char> bytes;
  read(offset, sizeof(Layout), bytes);
  Layout layout;
  std::memcpy(&layout, bytes.data(), sizeof(Layout));
  return layout;
}

void MapFileReader::readMagicAndVersion() {
  constexpr std::size_t kMagicSize = sizeof kMapMagic - 1;
  if (size_ < kMagicSize) fail(0, "not a saw_ndt map: too short");
  std::vector<char> magic;
  read(0, kMagicSize, magic);
  if (std::memcmp(magic.data(), kMapMagic, kMagicSize) != 0) fail(0, "not a saw_ndt map");
  version_ = read<boost::endian::little_uint32_buf_t>(kMagicSize).value();
  if (version_ < kFirstMapVersion || version_ > kMapVersion) {
    fail(kMagicSize, "map version " + std::to_string(version_) + ", this program reads versions " +
                         std::to_string(kFirstMapVersion) + " to " + std::to_string(kMapVersion));
  }
}

void MapFileReader::readHeader() {
  const auto header = read<MapHeaderLayout>(0);
  if (header.checksum.value() != checksumOf(&header, offsetof(MapHeaderLayout, checksum))) {
    fail(offsetof(MapHeaderLayout, checksum), "damaged: the header's checksum does not match");
  }
  if (header.header_bytes.value() != sizeof header || header.tile_size.value() != kTileSize ||
      header.flags.value() > kLabelledFlag) {
    fail(offsetof(MapHeaderLayout, header_bytes), "damaged: the header states an unknown layout");
  }
  origin_.resolution_m = header.resolution_m.value();
  if (!(origin_.resolution_m > 0.0) || !std::isfinite(origin_.resolution_m)) {
    fail(offsetof(MapHeaderLayout, resolution_m), "damaged: the resolution is not a positive number");
  }
  origin_.labelled = header.flags.value() == kLabelledFlag;
  origin_.scan_count = header.scan_count.value();
  origin_.point_count = header.point_count.value();
  entry_count_ = header.entry_count.value();
  const std::uint64_t tile_count = header.tile_count.value();
  const std::uint32_t metadata_bytes = version_ == kFirstMapVersion ? 0 : header.metadata_bytes.value();
  const std::uint64_t body = size_ - sizeof header;
  if (metadata_bytes > body || tile_count > (body - metadata_bytes) / sizeof(MapTileLayout) ||
      entry_count_ > body / kEntryBytes ||
      metadata_bytes + tile_count * sizeof(MapTileLayout) + entry_count_ * kEntryBytes != body) {
    fail(size_, "truncated or damaged: " + std::to_string(metadata_bytes) + " bytes of metadata, " +
                    std::to_string(tile_count) + " tiles and " + std::to_string(entry_count_) +
                    " entries do not make this size");
  }
  if (version_ != kFirstMapVersion) readMetadata(metadata_bytes, header.metadata_checksum.value());
  directory_offset_ = sizeof header + metadata_bytes;
  readDirectory(tile_count, header.directory_checksum.value());
}

void MapFileReader::readMetadata(std::uint32_t size, std::uint32_t checksum) {
  constexpr std::uint64_t kOffset = sizeof(MapHeaderLayout);
  std::vector<char> bytes;
  read(kOffset, size, bytes);
  if (checksumOf(bytes.data(), bytes.size()) != checksum) {
    fail(kOffset, "damaged: the metadata's checksum does not match");
  }
  if (const auto fault = internal::readMetadata({bytes.data(), bytes.size()}, origin_)) {
    fail(kOffset + fault->offset, fault->reason);
  }
}

void MapFileReader::readDirectory(std::uint64_t tile_count, std::uint32_t checksum) {
  std::vector<char> bytes;
  read(directory_offset_, tile_count * sizeof(MapTileLayout), bytes);
  if (checksumOf(bytes.data(), bytes.size()) != checksum) {
    fail(directory_offset_, "damaged: the directory's checksum does not match");
  }
  tiles_.resize(tile_count);
  std::uint64_t offset = directory_offset_ + bytes.size(), entry_count = 0;
  for (std::size_t i = 0; i < tiles_.size(); ++i) {
    MapTileLayout layout;
    std::memcpy(&layout, bytes.data() + i * sizeof layout, sizeof layout);
    Tile& tile = tiles_[i];
    for (int axis = 0; axis < 3; ++axis) tile.coordinate[axis] = layout.coordinate[axis].value();
    tile.checksum = layout.checksum.value();
    tile.entry_count = layout.entry_count.value();
    tile.offset = layout.offset.value();
    const std::uint64_t record = directory_offset_ + i * sizeof layout;
    constexpr int kLimit = 1 << (31 - kTileBits);
    if ((tile.coordinate.array() < -kLimit).any() || (tile.coordinate.array() >= kLimit).any()) {
      fail(record, "damaged: a tile lies outside the coordinates that a map can hold");
    }
    const auto by_z_y_x = [](const Tile& t) { return Eigen::Vector3i(t.coordinate.reverse()); };
    if (tile.offset != offset || tile.entry_count > (size_ - offset) / kEntryBytes) {
      fail(record, "damaged: a tile does not follow the one before it");
    }
    if (i > 0) {
      const Eigen::Vector3i before = by_z_y_x(tiles_[i - 1]), here = by_z_y_x(tile);
      if (!std::lexicographical_compare(before.data(), before.data() + 3, here.data(), here.data() + 3)) {
        fail(record, "damaged: a tile is out of order");
      }
    }
    offset += tile.entry_count * kEntryBytes;
    entry_count += tile.entry_count;
  }
  if (entry_count != entry_count_) {
    fail(directory_offset_, "damaged: the directory and the header disagree on the number of entries");
  }
}

std::uint64_t MapFileReader::endOfNextPiece() const {
  const std::uint64_t begin = tiles_[next_tile_].offset + entries_of_tile_read_ * kEntryBytes;
  std::uint64_t end = begin, read = entries_of_tile_read_;
  for (std::size_t t = next_tile_; t < tiles_.size();) {
    const std::uint64_t count = std::min(tiles_[t].entry_count - read, kMostEntriesPerPart);
    if (end > begin && end + count * kEntryBytes - begin > kMostBytesPerPiece) break;
    end += count * kEntryBytes;
    read += count;
    if (read == tiles_[t].entry_count) {
      read = 0;
      ++t;
    }
  }
  return end;
}

bool MapFileReader::readPiece(MapPiece& piece) {
  piece.parts.clear();
  while (next_tile_ < tiles_.size() && tiles_[next_tile_].entry_count == 0) ++next_tile_;
  if (next_tile_ == tiles_.size()) {
    checkEnd();
    return false;
  }
  const std::uint64_t begin = tiles_[next_tile_].offset + entries_of_tile_read_ * kEntryBytes;
  const std::uint64_t end = endOfNextPiece();
  read(begin, end - begin, piece.bytes);
  for (std::uint64_t offset = begin; offset < end;) {
    const Tile& tile = tiles_[next_tile_];
    const std::uint64_t left = tile.entry_count - entries_of_tile_read_;
    MapPart part;
    part.tile = next_tile_;
    part.offset = offset;
    part.bytes = piece.bytes.data() + (offset - begin);
    part.entry_count = std::min({left, kMostEntriesPerPart, (end - offset) / kEntryBytes});
    part.whole_tile = part.entry_count == tile.entry_count;
    if (part.entry_count < left) {
      // The last voxel may go on behind the part: it is left to the next one.
      const std::uint32_t last = entryAt(part, part.entry_count - 1).order() >> 8U;
      std::size_t count = part.entry_count;
      while (count > 0 && entryAt(part, count - 1).order() >> 8U == last) --count;
      if (count == 0) {
        if (offset > begin) break;
        fail(offset, "damaged: a voxel has more labels than there are");
      }
      part.entry_count = count;
    }
    if (!part.whole_tile) continueTile(part);
    entries_of_tile_read_ += part.entry_count;
    offset += part.entry_count * kEntryBytes;
    if (entries_of_tile_read_ == tile.entry_count) {
      entries_of_tile_read_ = 0;
      do ++next_tile_;
      while (next_tile_ < tiles_.size() && tiles_[next_tile_].entry_count == 0);
    }
    piece.parts.push_back(part);
  }
  return true;
}

// Checks what no part of a tile can tell alone.
void MapFileReader::continueTile(const MapPart& part) {
  const Tile& tile = tiles_[part.tile];
  const bool first = entries_of_tile_read_ == 0;
  checksum_of_tile_ = checksumOf(part.bytes, part.entry_count * kEntryBytes, first ? 0 : checksum_of_tile_);
  if (!first && entryAt(part, 0).order() <= last_place_in_tile_) {
    fail(part.offset, "damaged: an entry is out of range or out of order");
  }
  last_place_in_tile_ = entryAt(part, part.entry_count - 1).order();
  if (entries_of_tile_read_ + part.entry_count == tile.entry_count && checksum_of_tile_ != tile.checksum) {
    fail(tile.offset, "damaged: the checksum of a tile does not match");
  }
}

void MapFileReader::decode(const MapPart& part, std::vector<LabelledVoxelSums>& entries) {
  const Tile& tile = tiles_[part.tile];
  if (part.whole_tile && checksumOf(part.bytes, part.entry_count * kEntryBytes) != tile.checksum) {
    fail(part.offset, "damaged: the checksum of a tile does not match");
  }
  entries.resize(part.entry_count);
  std::uint64_t points = 0;
  std::uint32_t before = 0;
  for (std::size_t i = 0; i < part.entry_count; ++i) {
    const MapEntryLayout layout = entryAt(part, i);
    if (!decoded(layout, tile.coordinate, entries[i]) || entries[i].sums.count > origin_.point_count ||
        entries[i].scan_count > (version_ < kFirstVersionWithScans ? 0 : origin_.scan_count) ||
        (i > 0 && layout.order() <= before)) {
      fail(part.offset + i * kEntryBytes, "damaged: an entry is out of range or out of order");
    }
    before = layout.order();
    points += entries[i].sums.count;
  }
  points_ += points;
}

void MapFileReader::checkEnd() const {
  if (points_ != origin_.point_count) {
    fail(directory_offset_, "damaged: the entries and the header disagree on the number of points");
  }
}

}  // namespace saw_ndt::internal
