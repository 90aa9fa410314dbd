#include "map/localization_map_writer.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "map/map_file_layout.h"
#include "map/map_metadata.h"
#include "map/weighting_fields.h"

namespace saw_ndt::internal {

LocalizationMapWriter::LocalizationMapWriter(const std::string& path, const MapOrigin& origin,
                                             const VoxelWeighting& weighting)
    : origin_(origin), metadata_(metadataText(origin) + weightingText(weighting)), output_(path) {
  offset_ = sizeof(LocalizationMapHeader) + metadata_.size();
  output_.stream().seekp(static_cast<std::streamoff>(offset_));
}

void LocalizationMapWriter::add(const PackedTile& tile) {
  LocalizationTileRecord record;
  record.x = tile.at.x;
  record.y = tile.at.y;
  record.offset = offset_;
  record.cell_bytes = static_cast<std::uint32_t>(tile.cells.size());
  record.cell_checksum = checksumOf(tile.cells.data(), tile.cells.size());
  record.table_bytes = static_cast<std::uint32_t>(tile.table.size());
  record.table_checksum = checksumOf(tile.table.data(), tile.table.size());
  record.voxel_count = static_cast<std::uint32_t>(tile.voxel_count);
  record.checksum = checksumOf(&record, offsetof(LocalizationTileRecord, checksum));
  directory_.emplace(tile.at, record);
  output_.stream() << tile.cells << tile.table;
  offset_ += tile.cells.size() + tile.table.size();
  voxel_count_ += tile.voxel_count;
  coarse_voxel_count_ += tile.coarse_voxel_count;
}

void LocalizationMapWriter::finish() {
  std::ostream& stream = output_.stream();
  LocalizationMapHeader header;
  std::memset(&header, 0, sizeof header);
  std::memcpy(header.magic, kLocalizationMapMagic, sizeof header.magic);
  header.version = kLocalizationMapVersion;
  header.header_bytes = static_cast<std::uint32_t>(sizeof header);
  header.resolution_m = origin_.resolution_m;
  header.tile_m = kLocalizationTile_m;
  header.labelled = origin_.labelled ? 1U : 0U;
  header.metadata_bytes = static_cast<std::uint32_t>(metadata_.size());
  header.scan_count = origin_.scan_count;
  header.point_count = origin_.point_count;
  header.voxel_count = voxel_count_;
  header.coarse_voxel_count = coarse_voxel_count_;
  header.tile_count = directory_.size();
  header.directory_offset = offset_;
  header.file_bytes = offset_ + directory_.size() * sizeof(LocalizationTileRecord);
  writeExtent(header);
  header.metadata_checksum = checksumOf(metadata_.data(), metadata_.size());
  header.checksum = checksumOf(&header, offsetof(LocalizationMapHeader, checksum));
  for (const auto& [at, record] : directory_) {
    stream.write(reinterpret_cast<const char*>(&record), sizeof record);
  }
  stream.seekp(0);
  stream.write(reinterpret_cast<const char*>(&header), sizeof header);
  stream << metadata_;
  output_.commit();
}

void LocalizationMapWriter::writeExtent(LocalizationMapHeader& header) const {
  if (directory_.empty()) return;
  int least_x = std::numeric_limits<int>::max(), greatest_x = std::numeric_limits<int>::min();
  for (const auto& [at, record] : directory_) {
    least_x = std::min(least_x, at.x);
    greatest_x = std::max(greatest_x, at.x);
  }
  header.least_m[0] = least_x * kLocalizationTile_m;
  header.least_m[1] = directory_.begin()->first.y * kLocalizationTile_m;
  header.greatest_m[0] = (greatest_x + 1.0) * kLocalizationTile_m;
  header.greatest_m[1] = (directory_.rbegin()->first.y + 1.0) * kLocalizationTile_m;
}

}  // namespace saw_ndt::internal
