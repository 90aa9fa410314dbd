#pragma once

#include <boost/endian/buffers.hpp>
#include <cstddef>
#include <cstdint>

namespace saw_ndt::internal {

// The localization map file, version 1, little-endian throughout:
//
//   header     160 bytes, see below
//   metadata   how the map was made and weighted, as text (see map_metadata.h and weighting_fields.h)
//   tiles      one after the other, each of cells (see localization_tile.h) and a search table (see place_table.h)
//   directory  40 bytes a tile, ordered by y, x
//
// A record of the directory has a checksum of its own, and so have the cells and the table of a tile: whatever is used
// is checked, and what is not used is not read.

constexpr char kLocalizationMapMagic[9] = "SAWNDTL\n";
constexpr std::uint32_t kLocalizationMapVersion = 1;

struct LocalizationMapHeader {
  char magic[8];
  boost::endian::little_uint32_buf_t version;
  boost::endian::little_uint32_buf_t header_bytes;
  boost::endian::little_float64_buf_t resolution_m;  // of the statistics map that it was derived from
  boost::endian::little_float64_buf_t tile_m;
  boost::endian::little_uint32_buf_t labelled;  // 0 or 1
  boost::endian::little_uint32_buf_t metadata_bytes;
  boost::endian::little_uint64_buf_t scan_count;
  boost::endian::little_uint64_buf_t point_count;
  boost::endian::little_uint64_buf_t voxel_count;         // on the levels that match
  boost::endian::little_uint64_buf_t coarse_voxel_count;  // on the coarse one
  boost::endian::little_uint64_buf_t tile_count;
  boost::endian::little_uint64_buf_t directory_offset;
  boost::endian::little_uint64_buf_t file_bytes;
  boost::endian::little_float64_buf_t least_m[2];     // corner of what its tiles cover
  boost::endian::little_float64_buf_t greatest_m[2];  // likewise
  boost::endian::little_uint32_buf_t metadata_checksum;
  char reserved[24];
  boost::endian::little_uint32_buf_t checksum;  // CRC-32 of the header before it
};
static_assert(sizeof(LocalizationMapHeader) == 160);

struct LocalizationTileRecord {
  boost::endian::little_int32_buf_t x;
  boost::endian::little_int32_buf_t y;
  boost::endian::little_uint64_buf_t offset;  // of the cells; the table follows
  boost::endian::little_uint32_buf_t cell_bytes;
  boost::endian::little_uint32_buf_t cell_checksum;
  boost::endian::little_uint32_buf_t table_bytes;  // 0: nothing stands there
  boost::endian::little_uint32_buf_t table_checksum;
  boost::endian::little_uint32_buf_t voxel_count;  // on the levels that match
  boost::endian::little_uint32_buf_t checksum;     // CRC-32 of the record before it
};
static_assert(sizeof(LocalizationTileRecord) == 40);

}  // namespace saw_ndt::internal
