#include "map/map_file_writer.h"

#include <algorithm>
#include <stdexcept>

#include "map/map_file.h"
#include "map/map_tile.h"

namespace saw_ndt::internal {

MapFileWriter::MapFileWriter(const std::string& path, const MapOrigin& origin, std::uint64_t tile_count)
    : output_(path), origin_(origin), tile_count_(tile_count), size_(bytesOfFront(origin, tile_count)) {
  // The front is known once all tiles are.
  output_.stream().seekp(static_cast<std::streamoff>(size_));
  tiles_.reserve(tile_count);
}

void MapFileWriter::add(const LabelledVoxelSums* first, const LabelledVoxelSums* last) {
  const MapTileRecord tile = encodeTile(first, last, bytes_);
  add(tile, bytes_.data());
}

void MapFileWriter::add(MapTileRecord tile, const char* bytes) {
  const std::uint64_t byte_count = bytesOfEntries(tile.entry_count);
  tile.offset = size_;
  tiles_.push_back(tile);
  output_.stream().write(bytes, static_cast<std::streamsize>(byte_count));
  size_ += byte_count;
}

void MapFileWriter::commit(std::uint64_t point_count) {
  const auto not_ascending = [](const MapTileRecord& a, const MapTileRecord& b) {
    return !tileInMapOrder(a.coordinate, b.coordinate);
  };
  if (tiles_.size() != tile_count_ || std::adjacent_find(tiles_.begin(), tiles_.end(), not_ascending) != tiles_.end()) {
    throw std::logic_error("a map file is written from all of its tiles in map order");
  }
  origin_.point_count = point_count;
  const std::string front = encodeFront(origin_, tiles_);
  output_.stream().seekp(0);
  output_.stream().write(front.data(), static_cast<std::streamsize>(front.size()));
  output_.commit();
}

void writeMapFile(const std::string& path, const MapOrigin& origin, const std::vector<LabelledVoxelSums>& entries) {
  const std::vector<std::size_t> ends = endsOfTiles(entries);
  MapFileWriter writer(path, origin, ends.size());
  std::size_t first = 0;
  for (const std::size_t end : ends) {
    writer.add(entries.data() + first, entries.data() + end);
    first = end;
  }
  writer.commit(origin.point_count);
}

}  // namespace saw_ndt::internal
