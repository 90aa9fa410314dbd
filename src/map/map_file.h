#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "common/mapped_file.h"
#include "map/map_front.h"
#include "saw_ndt/common/export.h"
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
// Version 4 is a file that was updated in place (see map_update.h): tiles stand anywhere, metadata and directory behind
// those that came last. Of the 16 bytes of the header, the first u64 tells where the metadata begin, which the
// directory follows, and the second one where the map ends: what is behind belongs to an update that was broken off.
// What a header tells of is never written again.
//
// Versions 1 and 2 are read as well. They do not tell scans: their count has 64 bits. Version 1 has no metadata, and
// zeros in their place in the header.
//
// Means, covariances, confidences and weights follow exactly from the sums and are not repeated. With the directory,
// the tiles of a region can be found and checked without reading any other.

/// @param entries  in map order (see map_tile.h)
/// @throws Error where the file cannot be written; nothing is left behind then
void writeMapFile(const std::string& path, const MapOrigin& origin, const std::vector<LabelledVoxelSums>& entries);

/// Entries of one tile as they stand in the file: whole voxels, all of the tile's or so many as a part may hold.
struct MapPart {
  std::uint64_t tile = 0;  ///< its place in the directory
  bool whole_tile = false;
  std::uint64_t offset = 0;  ///< in the file
  std::size_t entry_count = 0;
};

/// Parts that follow each other in map order.
struct MapPiece {
  std::vector<MapPart> parts;
};

/// Reads a map file, which is mapped into memory: all of it in pieces of a few megabytes, or tiles here and there.
/// Every failure is an Error that names the file, the offset and the reason.
class SAW_NDT_EXPORT MapFileReader {
 public:
  /// Reads everything but the entries.
  /// @throws Error where the file is missing, truncated, damaged, of another version or no map at all
  explicit MapFileReader(const std::string& path);

  const std::string& path() const { return path_; }
  const MapFront& front() const { return front_; }
  const MapOrigin& origin() const { return front_.origin(); }
  std::uint64_t entryCount() const { return front_.entryCount(); }
  std::uint64_t tileCount() const { return front_.tileCount(); }

  /// The bytes of the header.
  std::string header() const;

  /// Finds the next piece; false behind the last one. All parts of the piece before it must have been decoded: their
  /// memory is given back.
  bool readPiece(MapPiece& piece);
  /// Replaces `entries` by those of a part, in map order. May be called by several threads at a time.
  void decode(const MapPart& part, std::vector<LabelledVoxelSums>& entries);

  /// Replaces `entries` by all those of a tile, in map order. May be called by several threads at a time.
  void decodeTile(std::uint64_t tile, std::vector<LabelledVoxelSums>& entries);
  /// The bytes of a tile's entries, not checked.
  const char* bytesOf(const MapTileRecord& tile) const { return file_.data() + tile.offset; }
  /// The voxel of an entry of a tile, not checked.
  VoxelCoordinate voxelOf(const MapTileRecord& tile, std::uint64_t entry) const;
  /// Gives the memory of a tile's bytes back.
  void forget(const MapTileRecord& tile) const;

  /// To be called once every tile has been decoded, in whatever way, once.
  /// @throws Error where there are other than so many points
  void checkEnd() const;

 private:
  [[noreturn]] void fail(std::uint64_t offset, const std::string& reason) const { failAt(path_, offset, reason); }
  MapPart nextPart() const;
  void continueTile(const MapPart& part);

  std::string path_;
  MappedFile file_;
  MapFront front_;

  std::uint64_t next_tile_ = 0;
  std::uint64_t entries_of_tile_read_ = 0;
  std::uint32_t checksum_of_tile_ = 0;    // of its parts so far, where it has several
  std::uint32_t last_place_in_tile_ = 0;  // of the part before, likewise
  std::atomic<std::uint64_t> points_{0};
};

}  // namespace saw_ndt::internal
