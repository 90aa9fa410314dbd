#pragma once

#include <atomic>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include "saw_ndt/map/weighted_voxel_map.h"

namespace saw_ndt::internal {

// The map file, version 3, little-endian throughout:
//
//   header     96 bytes: magic "SAWNDTM\n", u32 version, u32 header bytes, f64 resolution (m), u32 tile size (voxels),
//              u32 flags (bit 0: labelled), u64 scans, u64 points, u64 entries, u64 tiles, u32 CRC-32 of the directory,
//              u32 metadata bytes, u32 CRC-32 of the metadata, 16 bytes zero, u32 CRC-32 of the header before it
//   metadata   how the map was made, as text (see map_metadata.h)
//   directory  40 bytes a tile, ordered by z, y, x: i32 x y z, u32 CRC-32 of the tile's entries, u64 entries,
//              u64 offset in the file, u64 zero
//   entries    84 bytes each, tile after tile, ordered by z, y, x, label: u8 x y z within the tile, u8 label, u40
//              count, u24 scans that met it (at most 2^24 - 1), i64 sum x y z, i64 product xx xy xz yy yz zz
//              (VoxelSums)
//
// Versions 1 and 2 are read as well. They do not tell scans: their count has 64 bits. Version 1 has no metadata, and
// zeros in their place in the header.
//
// Means, covariances, confidences and weights follow exactly from the sums and are not repeated. With the directory in
// front, the tiles of a region can be found and checked without reading any other.

/// @param entries  in map order (see map_tile.h)
/// @throws Error where the file cannot be written; nothing is left behind then
void writeMapFile(const std::string& path, const MapOrigin& origin, const std::vector<LabelledVoxelSums>& entries);

/// Entries of one tile as they stand in the file: whole voxels, all of the tile's or so many as a part may hold.
struct MapPart {
  std::size_t tile = 0;  ///< its place in the directory
  bool whole_tile = false;
  std::uint64_t offset = 0;  ///< in the file
  std::size_t entry_count = 0;
  const char* bytes = nullptr;
};

/// Parts that follow each other in the file, and the memory of them.
struct MapPiece {
  std::vector<char> bytes;
  std::vector<MapPart> parts;
};

/// Reads a map file in pieces of a few megabytes at most. Every failure is an Error that names the file, the offset and
/// the reason; sizes are checked against the file's own before anything is allocated.
class MapFileReader {
 public:
  /// Reads everything but the entries.
  /// @throws Error where the file is missing, truncated, damaged, of another version or no map at all
  explicit MapFileReader(const std::string& path);

  const MapOrigin& origin() const { return origin_; }
  std::uint64_t entryCount() const { return entry_count_; }

  /// Reads the next piece; false behind the last one. All parts of the piece before it must have been decoded.
  bool readPiece(MapPiece& piece);
  /// Replaces `entries` by those of a part, in map order. May be called by several threads at a time.
  void decode(const MapPart& part, std::vector<LabelledVoxelSums>& entries);

 private:
  struct Tile {
    Eigen::Vector3i coordinate;
    std::uint32_t checksum = 0;
    std::uint64_t entry_count = 0;
    std::uint64_t offset = 0;
  };

  [[noreturn]] void fail(std::uint64_t offset, const std::string& reason) const;
  void read(std::uint64_t offset, std::size_t count, std::vector<char>& bytes);
  template <typename Layout>
  Layout read(std::uint64_t offset);
  void readMagicAndVersion();
  void readHeader();
  void readMetadata(std::uint32_t size, std::uint32_t checksum);
  void readDirectory(std::uint64_t tile_count, std::uint32_t checksum);
  std::uint64_t endOfNextPiece() const;
  void continueTile(const MapPart& part);
  void checkEnd() const;

  std::string path_;
  std::ifstream stream_;
  std::uint64_t size_ = 0;
  std::uint32_t version_ = 0;
  MapOrigin origin_;
  std::uint64_t entry_count_ = 0;
  std::uint64_t directory_offset_ = 0;
  std::vector<Tile> tiles_;

  std::size_t next_tile_ = 0;
  std::uint64_t entries_of_tile_read_ = 0;
  std::uint32_t checksum_of_tile_ = 0;    // of its parts so far, where it has several
  std::uint32_t last_place_in_tile_ = 0;  // of the part before, likewise
  std::atomic<std::uint64_t> points_{0};
};

}  // namespace saw_ndt::internal
