#pragma once

#include <zlib.h>

#include <boost/endian/buffers.hpp>
#include <cstddef>
#include <cstdint>

#include "map/map_tile.h"

namespace saw_ndt::internal {

// What map_file.h describes, byte for byte.

constexpr char kMapMagic[9] = "SAWNDTM\n";
constexpr std::uint32_t kMapVersion = 3;         // of new files
constexpr std::uint32_t kUpdatedMapVersion = 4;  // of those that were updated in place
constexpr std::uint32_t kFirstMapVersion = 1;
constexpr std::uint32_t kFirstVersionWithScans = 3;
constexpr std::uint32_t kLabelledFlag = 1;

struct MapHeaderLayout {
  char magic[8];
  boost::endian::little_uint32_buf_t version;
  boost::endian::little_uint32_buf_t header_bytes;
  boost::endian::little_float64_buf_t resolution_m;
  boost::endian::little_uint32_buf_t tile_size;
  boost::endian::little_uint32_buf_t flags;
  boost::endian::little_uint64_buf_t scan_count;
  boost::endian::little_uint64_buf_t point_count;
  boost::endian::little_uint64_buf_t entry_count;
  boost::endian::little_uint64_buf_t tile_count;
  boost::endian::little_uint32_buf_t directory_checksum;
  boost::endian::little_uint32_buf_t metadata_bytes;
  boost::endian::little_uint32_buf_t metadata_checksum;
  boost::endian::little_uint64_buf_t front_offset;  // zero before version 4, as is the next one
  boost::endian::little_uint64_buf_t end_offset;
  boost::endian::little_uint32_buf_t checksum;
};
static_assert(sizeof(MapHeaderLayout) == 96);

struct MapTileLayout {
  boost::endian::little_int32_buf_t coordinate[3];
  boost::endian::little_uint32_buf_t checksum;
  boost::endian::little_uint64_buf_t entry_count;
  boost::endian::little_uint64_buf_t offset;
  char reserved[8];
};
static_assert(sizeof(MapTileLayout) == 40);

struct MapEntryLayout {
  std::uint8_t place[3];  // in the tile
  std::uint8_t label;
  boost::endian::little_uint40_buf_t count;
  boost::endian::little_uint24_buf_t scan_count;  // zero before version 3
  boost::endian::little_int64_buf_t sum[3];
  boost::endian::little_int64_buf_t product[6];

  // Ascends within a tile in map order.
  std::uint32_t order() const {
    return (static_cast<std::uint32_t>(place[2]) << 24U) | (static_cast<std::uint32_t>(place[1]) << 16U) |
           (static_cast<std::uint32_t>(place[0]) << 8U) | label;
  }
};
static_assert(sizeof(MapEntryLayout) == 84);

inline std::uint32_t checksumOf(const void* bytes, std::size_t size, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(crc32_z(before, static_cast<const Bytef*>(bytes), size));
}

}  // namespace saw_ndt::internal
