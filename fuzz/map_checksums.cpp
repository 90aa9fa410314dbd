#include "map_checksums.h"

#include <cstdint>
#include <cstring>

#include "map/localization_map_layout.h"
#include "map/map_file_bytes.h"
#include "map/map_file_layout.h"

namespace saw_ndt {
namespace {

using namespace internal;

constexpr std::uint64_t kMostTiles = 64;

bool lies(const std::string& bytes, std::uint64_t offset, std::uint64_t size) {
  return offset <= bytes.size() && size <= bytes.size() - offset;
}

std::uint32_t checksumAt(const std::string& bytes, std::uint64_t offset, std::uint64_t size) {
  return lies(bytes, offset, size) ? checksumOf(bytes.data() + offset, size) : 0;
}

/// With the checksum, its last member, of what stands before it.
template <typename Layout>
void write(std::string& bytes, std::uint64_t offset, Layout layout) {
  layout.checksum = checksumOf(&layout, sizeof layout - sizeof layout.checksum);
  std::memcpy(&bytes[offset], &layout, sizeof layout);
}

}  // namespace

void repairMapChecksums(std::string& bytes) {
  if (bytes.size() < sizeof(MapHeaderLayout)) return;
  auto header = valueAt<MapHeaderLayout>(bytes, 0);
  const bool updated = header.version.value() == kUpdatedMapVersion;
  const std::uint64_t metadata = updated ? header.front_offset.value() : sizeof header;
  const std::uint64_t metadata_bytes = header.version.value() == kFirstMapVersion ? 0 : header.metadata_bytes.value();
  const std::uint64_t directory = metadata + metadata_bytes, tiles = header.tile_count.value();
  for (std::uint64_t tile = 0; tile < tiles && tile < kMostTiles; ++tile) {
    const std::uint64_t place = directory + tile * sizeof(MapTileLayout);
    if (!lies(bytes, place, sizeof(MapTileLayout))) break;
    auto record = valueAt<MapTileLayout>(bytes, place);
    record.checksum = checksumAt(bytes, record.offset.value(), record.entry_count.value() * sizeof(MapEntryLayout));
    std::memcpy(&bytes[place], &record, sizeof record);
  }
  header.metadata_checksum = metadata_bytes == 0 ? 0 : checksumAt(bytes, metadata, metadata_bytes);
  header.directory_checksum = checksumAt(bytes, directory, tiles * sizeof(MapTileLayout));
  write(bytes, 0, header);
}

void repairLocalizationMapChecksums(std::string& bytes) {
  if (bytes.size() < sizeof(LocalizationMapHeader)) return;
  auto header = valueAt<LocalizationMapHeader>(bytes, 0);
  header.metadata_checksum = checksumAt(bytes, sizeof header, header.metadata_bytes.value());
  header.file_bytes = bytes.size();
  for (std::uint64_t tile = 0; tile < header.tile_count.value() && tile < kMostTiles; ++tile) {
    const std::uint64_t place = header.directory_offset.value() + tile * sizeof(LocalizationTileRecord);
    if (!lies(bytes, place, sizeof(LocalizationTileRecord))) break;
    auto record = valueAt<LocalizationTileRecord>(bytes, place);
    const std::uint64_t cells = record.offset.value();
    record.cell_checksum = checksumAt(bytes, cells, record.cell_bytes.value());
    record.table_checksum = checksumAt(bytes, cells + record.cell_bytes.value(), record.table_bytes.value());
    write(bytes, place, record);
  }
  write(bytes, 0, header);
}

}  // namespace saw_ndt
