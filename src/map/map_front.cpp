#include "map/map_front.h"

#include <cmath>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <thread>
#include <utility>

#include "map/localization_map_layout.h"
#include "map/map_file_layout.h"
#include "map/map_metadata.h"
#include "map/resolution_range.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {
namespace {

constexpr std::uint64_t kHeaderBytes = sizeof(MapHeaderLayout);
constexpr std::uint64_t kRecordBytes = sizeof(MapTileLayout);
constexpr std::uint64_t kEntryBytes = sizeof(MapEntryLayout);
// How often a file is looked at again that another process may be writing at the same time.
constexpr int kMostAttempts = 100;

bool checksumHolds(const MapHeaderLayout& header) {
  return header.checksum.value() == checksumOf(&header, offsetof(MapHeaderLayout, checksum));
}

// Whether the header tells of an update that the mapping is too old to reach.
bool wasUpdatedMeanwhile(const std::string& path, const MappedFile& file) {
  MapHeaderLayout header;
  if (file.size() < sizeof header) return false;
  std::memcpy(&header, file.data(), sizeof header);
  std::error_code error;
  return header.version.value() == kUpdatedMapVersion && checksumHolds(header) &&
         header.end_offset.value() > file.size() && std::filesystem::file_size(path, error) > file.size() && !error;
}

}  // namespace

void failAt(const std::string& path, std::uint64_t offset, const std::string& reason) {
  throw Error(path, "offset " + std::to_string(offset), reason);
}

MappedFile openMapFile(const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) throw Error(path, "", "is a folder, not a map file");
  for (int attempt = 1;; ++attempt) {
    MappedFile file(path);
    if (attempt == kMostAttempts || !wasUpdatedMeanwhile(path, file)) return file;
  }
}

MapFront::MapFront(std::string path, const MappedFile& file) : path_(std::move(path)), file_(file) {
  readMagicAndVersion();
  readHeader();
}

const char* MapFront::at(std::uint64_t offset, std::uint64_t count) const {
  if (offset > file_.size() || count > file_.size() - offset) {
    fail(file_.size(), "truncated: " + std::to_string(offset + count) + " bytes expected");
  }
  return file_.data() + offset;
}

void MapFront::readMagicAndVersion() {
  constexpr std::size_t kMagicSize = sizeof kMapMagic - 1;
  if (file_.size() < kMagicSize) fail(0, "not a saw_ndt map: too short");
  if (std::memcmp(file_.data(), kLocalizationMapMagic, kMagicSize) == 0) {
    fail(0, "is a localization map, where the statistics map is needed that it was packed from");
  }
  if (std::memcmp(file_.data(), kMapMagic, kMagicSize) != 0) fail(0, "not a saw_ndt map");
  boost::endian::little_uint32_buf_t version;
  std::memcpy(&version, at(kMagicSize, sizeof version), sizeof version);
  if (version.value() < kFirstMapVersion || version.value() > kUpdatedMapVersion) {
    fail(kMagicSize, "map version " + std::to_string(version.value()) + ", this program reads versions " +
                         std::to_string(kFirstMapVersion) + " to " + std::to_string(kUpdatedMapVersion));
  }
}

void MapFront::readHeader() {
  MapHeaderLayout header;
  std::memcpy(&header, at(0, sizeof header), sizeof header);
  // An update may be replacing it in this moment.
  for (int attempt = 1; attempt < kMostAttempts && !checksumHolds(header); ++attempt) {
    if (attempt + 2 >= kMostAttempts) std::this_thread::yield();
    std::memcpy(&header, at(0, sizeof header), sizeof header);
  }
  if (!checksumHolds(header)) {
    fail(offsetof(MapHeaderLayout, checksum), "damaged: the header's checksum does not match");
  }
  version_ = header.version.value();
  if (header.header_bytes.value() != sizeof header || header.tile_size.value() != kTileSize ||
      header.flags.value() > kLabelledFlag) {
    fail(offsetof(MapHeaderLayout, header_bytes), "damaged: the header states an unknown layout");
  }
  origin_.resolution_m = header.resolution_m.value();
  if (!isResolution(origin_.resolution_m)) {
    fail(offsetof(MapHeaderLayout, resolution_m), "damaged: the resolution is not that of a map");
  }
  origin_.labelled = header.flags.value() == kLabelledFlag;
  origin_.scan_count = header.scan_count.value();
  origin_.point_count = header.point_count.value();
  entry_count_ = header.entry_count.value();
  tile_count_ = header.tile_count.value();
  const bool updated = version_ == kUpdatedMapVersion;
  metadata_bytes_ = version_ == kFirstMapVersion ? 0 : header.metadata_bytes.value();
  metadata_offset_ = updated ? header.front_offset.value() : kHeaderBytes;
  end_offset_ = updated ? header.end_offset.value() : file_.size();
  if (end_offset_ > file_.size()) {
    fail(file_.size(), "truncated: " + std::to_string(end_offset_) + " bytes expected");
  }
  if (end_offset_ < kHeaderBytes || metadata_offset_ < kHeaderBytes || metadata_offset_ > end_offset_) {
    fail(offsetof(MapHeaderLayout, front_offset), "damaged: the directory lies outside the map");
  }
  const std::uint64_t body = end_offset_ - kHeaderBytes, front = end_offset_ - metadata_offset_;
  const bool fits = metadata_bytes_ <= front && tile_count_ <= (front - metadata_bytes_) / kRecordBytes &&
                    entry_count_ <= body / kEntryBytes;
  const std::uint64_t live = fits ? metadata_bytes_ + tile_count_ * kRecordBytes + entry_count_ * kEntryBytes : 0;
  if (!fits || (updated ? live > body : live != body)) {
    fail(end_offset_, "truncated or damaged: " + std::to_string(metadata_bytes_) + " bytes of metadata, " +
                          std::to_string(tile_count_) + " tiles and " + std::to_string(entry_count_) +
                          " entries do not make this size");
  }
  if (version_ != kFirstMapVersion) readMetadata(header.metadata_checksum.value());
  checkDirectory(header.directory_checksum.value());
}

void MapFront::readMetadata(std::uint32_t checksum) {
  const char* const bytes = at(metadata_offset_, metadata_bytes_);
  if (checksumOf(bytes, metadata_bytes_) != checksum) {
    fail(metadata_offset_, "damaged: the metadata's checksum does not match");
  }
  if (const auto fault = internal::readMetadata({bytes, metadata_bytes_}, origin_)) {
    fail(metadata_offset_ + fault->offset, fault->reason);
  }
}

std::uint64_t MapFront::offsetOfRecord(std::uint64_t place) const {
  return metadata_offset_ + metadata_bytes_ + place * kRecordBytes;
}

MapTileRecord MapFront::tile(std::uint64_t place) const {
  MapTileLayout layout;
  std::memcpy(&layout, file_.data() + offsetOfRecord(place), sizeof layout);
  MapTileRecord tile;
  for (int axis = 0; axis < 3; ++axis) tile.coordinate[axis] = layout.coordinate[axis].value();
  tile.checksum = layout.checksum.value();
  tile.entry_count = layout.entry_count.value();
  tile.offset = layout.offset.value();
  return tile;
}

void MapFront::checkDirectory(std::uint32_t checksum) const {
  const std::uint64_t directory = offsetOfRecord(0), directory_bytes = tile_count_ * kRecordBytes;
  if (checksumOf(at(directory, directory_bytes), directory_bytes) != checksum) {
    fail(directory, "damaged: the directory's checksum does not match");
  }
  std::uint64_t next_offset = directory + directory_bytes, entry_count = 0;
  MapTileRecord before;
  for (std::uint64_t i = 0; i < tile_count_; ++i) {
    const MapTileRecord here = tile(i);
    constexpr int kLimit = 1 << (31 - kTileBits);
    if ((here.coordinate.array() < -kLimit).any() || (here.coordinate.array() >= kLimit).any()) {
      fail(offsetOfRecord(i), "damaged: a tile lies outside the coordinates that a map can hold");
    }
    const bool follows = version_ == kUpdatedMapVersion || here.offset == next_offset;
    if (!follows || here.offset < kHeaderBytes || here.offset > end_offset_ ||
        here.entry_count > (end_offset_ - here.offset) / kEntryBytes) {
      fail(offsetOfRecord(i), version_ == kUpdatedMapVersion ? "damaged: a tile does not lie within the map"
                                                             : "damaged: a tile does not follow the one before it");
    }
    if (i > 0 && !tileInMapOrder(before.coordinate, here.coordinate)) {
      fail(offsetOfRecord(i), "damaged: a tile is out of order");
    }
    next_offset += here.entry_count * kEntryBytes;
    entry_count += here.entry_count;
    before = here;
  }
  file_.forget(directory, directory_bytes);
  if (entry_count != entry_count_) {
    fail(directory, "damaged: the directory and the header disagree on the number of entries");
  }
}

std::uint64_t MapFront::deadBytes() const {
  return file_.size() - kHeaderBytes - metadata_bytes_ - tile_count_ * kRecordBytes - entry_count_ * kEntryBytes;
}

}  // namespace saw_ndt::internal
