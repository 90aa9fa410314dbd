#pragma once

#include <cstdint>
#include <string>

#include "common/mapped_file.h"
#include "map/map_tile.h"
#include "saw_ndt/map/weighted_voxel_map.h"

namespace saw_ndt::internal {

/// Throws an Error about a place of a map file.
[[noreturn]] void failAt(const std::string& path, std::uint64_t offset, const std::string& reason);

/// Maps a map file into memory: one that is updated in place meanwhile, as it was before or is afterwards.
/// @throws Error where there is no such file
MappedFile openMapFile(const std::string& path);

/// What a map file tells but its entries. The directory stays in the file: its tiles are read as they are asked for.
class MapFront {
 public:
  /// Reads and checks everything but the entries. Sizes are checked against the file's own before anything is
  /// allocated.
  /// @param file  must live as long as this
  /// @throws Error where the file is truncated, damaged, of another version or no map at all
  MapFront(std::string path, const MappedFile& file);

  std::uint32_t version() const { return version_; }
  const MapOrigin& origin() const { return origin_; }
  std::uint64_t entryCount() const { return entry_count_; }
  std::uint64_t tileCount() const { return tile_count_; }
  /// A tile by its place in map order.
  MapTileRecord tile(std::uint64_t place) const;
  /// Where a tile's record stands in the file, and that of the first one where the directory does.
  std::uint64_t offsetOfRecord(std::uint64_t place) const;

  /// Where the file ends as far as it belongs to the map. Behind it is what is left of an update that was broken off.
  std::uint64_t endOffset() const { return end_offset_; }
  /// Bytes of the file that do not belong to the map any more: what updates have replaced, and what is behind the end.
  std::uint64_t deadBytes() const;

 private:
  [[noreturn]] void fail(std::uint64_t offset, const std::string& reason) const { failAt(path_, offset, reason); }
  const char* at(std::uint64_t offset, std::uint64_t count) const;
  void readMagicAndVersion();
  void readHeader();
  void readMetadata(std::uint32_t checksum);
  void checkDirectory(std::uint32_t checksum) const;

  std::string path_;
  const MappedFile& file_;
  std::uint32_t version_ = 0;
  MapOrigin origin_;
  std::uint64_t entry_count_ = 0;
  std::uint64_t tile_count_ = 0;
  std::uint64_t metadata_offset_ = 0;
  std::uint64_t metadata_bytes_ = 0;
  std::uint64_t end_offset_ = 0;
};

}  // namespace saw_ndt::internal
