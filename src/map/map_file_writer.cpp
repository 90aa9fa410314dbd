#include <algorithm>
#include <cstring>

#include "common/atomic_output.h"
#include "map/map_file.h"
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
void write(std::ostream& stream, const std::vector<Layout>& layouts) {
  stream.write(reinterpret_cast<const char*>(layouts.data()),
               static_cast<std::streamsize>(layouts.size() * sizeof(Layout)));
}

}  // namespace

void writeMapFile(const std::string& path, const MapOrigin& origin, const std::vector<LabelledVoxelSums>& entries) {
  std::size_t tile_count = 0;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (i == 0 || tileOf(entries[i].voxel) != tileOf(entries[i - 1].voxel)) ++tile_count;
  }
  const std::string metadata = metadataText(origin);
  const std::uint64_t directory_offset = sizeof(MapHeaderLayout) + metadata.size();
  std::uint64_t offset = directory_offset + tile_count * sizeof(MapTileLayout);

  AtomicOutput output(path);
  std::ostream& stream = output.stream();
  // The checksums in front are known once what they are of has been encoded, a tile at a time.
  stream.seekp(static_cast<std::streamoff>(offset));
  std::vector<MapTileLayout> directory;
  directory.reserve(tile_count);
  std::vector<MapEntryLayout> of_tile;
  for (std::size_t i = 0; i < entries.size();) {
    const Eigen::Vector3i tile = tileOf(entries[i].voxel);
    of_tile.clear();
    for (; i < entries.size() && tileOf(entries[i].voxel) == tile; ++i) of_tile.push_back(encoded(entries[i]));
    const std::size_t bytes = of_tile.size() * sizeof(MapEntryLayout);
    MapTileLayout& layout = directory.emplace_back();
    std::memset(&layout, 0, sizeof layout);
    for (int axis = 0; axis < 3; ++axis) layout.coordinate[axis] = tile[axis];
    layout.checksum = checksumOf(of_tile.data(), bytes);
    layout.entry_count = of_tile.size();
    layout.offset = offset;
    write(stream, of_tile);
    offset += bytes;
  }

  MapHeaderLayout header;
  std::memset(&header, 0, sizeof header);
  std::memcpy(header.magic, kMapMagic, sizeof header.magic);
  header.version = kMapVersion;
  header.header_bytes = static_cast<std::uint32_t>(sizeof header);
  header.resolution_m = origin.resolution_m;
  header.tile_size = static_cast<std::uint32_t>(kTileSize);
  header.flags = origin.labelled ? kLabelledFlag : std::uint32_t{0};
  header.scan_count = origin.scan_count;
  header.point_count = origin.point_count;
  header.entry_count = entries.size();
  header.tile_count = tile_count;
  header.directory_checksum = checksumOf(directory.data(), directory.size() * sizeof(MapTileLayout));
  header.metadata_bytes = static_cast<std::uint32_t>(metadata.size());
  header.metadata_checksum = checksumOf(metadata.data(), metadata.size());
  header.checksum = checksumOf(&header, offsetof(MapHeaderLayout, checksum));
  stream.seekp(0);
  write(stream, std::vector<MapHeaderLayout>{header});
  stream.write(metadata.data(), static_cast<std::streamsize>(metadata.size()));
  write(stream, directory);
  output.commit();
}

}  // namespace saw_ndt::internal
