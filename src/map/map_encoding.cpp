#include "map/map_encoding.h"

#include <algorithm>
#include <cstring>
#include <optional>

#include "map/map_file_layout.h"
#include "map/map_metadata.h"
#include "map/voxel_sums_table.h"

namespace saw_ndt::internal {
namespace {

MapEntryLayout encoded(const LabelledVoxelSums& entry) {
  MapEntryLayout layout;
  const Eigen::Vector3i place = entry.voxel - kTileSize * tileOf(entry.voxel);
  for (int axis = 0; axis < 3; ++axis) layout.place[axis] = static_cast<std::uint8_t>(place[axis]);
  layout.label = static_cast<std::uint8_t>(entry.label);
  layout.count = entry.sums.count;
  layout.scan_count = std::min(entry.scan_count, kMostScansOfVoxel);
  for (std::size_t i = 0; i < entry.sums.sum.size(); ++i) layout.sum[i] = entry.sums.sum[i];
  for (std::size_t i = 0; i < entry.sums.product.size(); ++i) layout.product[i] = entry.sums.product[i];
  return layout;
}

template <typename Layout>
void append(const Layout& layout, std::string& bytes) {
  bytes.append(reinterpret_cast<const char*>(&layout), sizeof layout);
}

std::string encodeDirectory(const std::vector<MapTileRecord>& tiles) {
  std::string bytes;
  bytes.reserve(tiles.size() * sizeof(MapTileLayout));
  MapTileLayout layout;
  std::memset(&layout, 0, sizeof layout);
  for (const MapTileRecord& tile : tiles) {
    for (int axis = 0; axis < 3; ++axis) layout.coordinate[axis] = tile.coordinate[axis];
    layout.checksum = tile.checksum;
    layout.entry_count = tile.entry_count;
    layout.offset = tile.offset;
    append(layout, bytes);
  }
  return bytes;
}

// @param front_offset  where metadata and directory stand that were appended; nothing: behind the header
std::string encodeHeader(const MapOrigin& origin, const std::vector<MapTileRecord>& tiles, const std::string& metadata,
                         const std::string& directory, std::optional<std::uint64_t> front_offset) {
  MapHeaderLayout header;
  std::memset(&header, 0, sizeof header);
  std::memcpy(header.magic, kMapMagic, sizeof header.magic);
  header.version = front_offset ? kUpdatedMapVersion : kMapVersion;
  header.header_bytes = static_cast<std::uint32_t>(sizeof header);
  header.resolution_m = origin.resolution_m;
  header.tile_size = static_cast<std::uint32_t>(kTileSize);
  header.flags = origin.labelled ? kLabelledFlag : std::uint32_t{0};
  header.scan_count = origin.scan_count;
  header.point_count = origin.point_count;
  std::uint64_t entry_count = 0;
  for (const MapTileRecord& tile : tiles) entry_count += tile.entry_count;
  header.entry_count = entry_count;
  header.tile_count = tiles.size();
  header.directory_checksum = checksumOf(directory.data(), directory.size());
  header.metadata_bytes = static_cast<std::uint32_t>(metadata.size());
  header.metadata_checksum = checksumOf(metadata.data(), metadata.size());
  if (front_offset) {
    header.front_offset = *front_offset;
    header.end_offset = *front_offset + metadata.size() + directory.size();
  }
  header.checksum = checksumOf(&header, offsetof(MapHeaderLayout, checksum));
  std::string bytes;
  append(header, bytes);
  return bytes;
}

}  // namespace

MapTileRecord encodeTile(const LabelledVoxelSums* first, const LabelledVoxelSums* last, std::vector<char>& bytes) {
  MapTileRecord tile;
  tile.coordinate = tileOf(first->voxel);
  tile.entry_count = static_cast<std::uint64_t>(last - first);
  bytes.resize(bytesOfEntries(tile.entry_count));
  char* place = bytes.data();
  for (const LabelledVoxelSums* entry = first; entry != last; ++entry, place += sizeof(MapEntryLayout)) {
    const MapEntryLayout layout = encoded(*entry);
    std::memcpy(place, &layout, sizeof layout);
  }
  tile.checksum = checksumOf(bytes.data(), bytes.size());
  return tile;
}

LabelledVoxelSums decodeEntry(const MapEntryLayout& layout, const Eigen::Vector3i& tile) {
  LabelledVoxelSums entry;
  for (int axis = 0; axis < 3; ++axis) entry.voxel[axis] = tile[axis] * kTileSize + layout.place[axis];
  entry.label = static_cast<StructuralLabel>(layout.label);
  entry.sums.count = layout.count.value();
  entry.scan_count = layout.scan_count.value();
  for (std::size_t i = 0; i < entry.sums.sum.size(); ++i) entry.sums.sum[i] = layout.sum[i].value();
  for (std::size_t i = 0; i < entry.sums.product.size(); ++i) entry.sums.product[i] = layout.product[i].value();
  return entry;
}

std::uint64_t bytesOfEntries(std::uint64_t entry_count) { return entry_count * sizeof(MapEntryLayout); }

std::string encodeFront(const MapOrigin& origin, const std::vector<MapTileRecord>& tiles) {
  const std::string metadata = metadataText(origin), directory = encodeDirectory(tiles);
  return encodeHeader(origin, tiles, metadata, directory, std::nullopt) + metadata + directory;
}

MapSwitch encodeSwitch(const MapOrigin& origin, const std::vector<MapTileRecord>& tiles, std::uint64_t front_offset) {
  const std::string metadata = metadataText(origin), directory = encodeDirectory(tiles);
  return {encodeHeader(origin, tiles, metadata, directory, front_offset), metadata + directory};
}

std::string asUpdatedHeader(const std::string& header, std::uint64_t end_offset) {
  MapHeaderLayout layout;
  std::memcpy(&layout, header.data(), sizeof layout);
  layout.version = kUpdatedMapVersion;
  layout.front_offset = sizeof layout;
  layout.end_offset = end_offset;
  layout.checksum = checksumOf(&layout, offsetof(MapHeaderLayout, checksum));
  std::string bytes;
  append(layout, bytes);
  return bytes;
}

std::uint64_t bytesOfFront(const MapOrigin& origin, std::uint64_t tile_count) {
  return sizeof(MapHeaderLayout) + metadataText(origin).size() + tile_count * sizeof(MapTileLayout);
}

}  // namespace saw_ndt::internal
