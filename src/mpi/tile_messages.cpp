#include "mpi/tile_messages.h"

#include <boost/endian/buffers.hpp>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "map/map_encoding.h"
#include "map/map_file_layout.h"
#include "map/voxel_sums_table.h"

namespace saw_ndt::internal {
namespace {

constexpr std::size_t kMessageBytes = std::size_t{1} << 24U;

struct TileHeader {
  boost::endian::little_int32_buf_t coordinate[3];
  boost::endian::little_uint32_buf_t entry_count;
};
static_assert(sizeof(TileHeader) == 16);

// Copies the next bytes of a message and moves `place` behind them.
template <typename Layout>
Layout take(const std::vector<char>& message, std::size_t& place) {
  Layout layout;
  if (message.size() - place < sizeof layout) throw std::invalid_argument("message: ends in the middle of a tile");
  std::memcpy(&layout, message.data() + place, sizeof layout);
  place += sizeof layout;
  return layout;
}

}  // namespace

int ownerOfTile(const Eigen::Vector3i& tile, int rank_count) {
  return static_cast<int>(hashCoordinate(tile) % static_cast<std::uint64_t>(rank_count));
}

std::vector<std::vector<std::vector<char>>> messagesByOwner(const WeightedMapBuilder& collected, int rank_count) {
  std::vector<std::vector<std::vector<char>>> messages(static_cast<std::size_t>(rank_count));
  std::vector<char> bytes;
  collected.forEachTile([&](const std::vector<LabelledVoxelSums>& entries) {
    const MapTileRecord tile = encodeTile(entries.data(), entries.data() + entries.size(), bytes);
    std::vector<std::vector<char>>& of_owner =
        messages[static_cast<std::size_t>(ownerOfTile(tile.coordinate, rank_count))];
    if (of_owner.empty() || of_owner.back().size() >= kMessageBytes) of_owner.emplace_back();
    TileHeader header;
    for (int axis = 0; axis < 3; ++axis) header.coordinate[axis] = tile.coordinate[axis];
    header.entry_count = static_cast<std::uint32_t>(tile.entry_count);
    const char* const header_bytes = reinterpret_cast<const char*>(&header);
    of_owner.back().insert(of_owner.back().end(), header_bytes, header_bytes + sizeof header);
    of_owner.back().insert(of_owner.back().end(), bytes.begin(), bytes.end());
  });
  return messages;
}

void addMessage(const std::vector<char>& message, WeightedMapBuilder& owned) {
  MapOrigin origin = owned.origin();
  origin.labelled = origin.segmentation.has_value();
  origin.scan_count = origin.point_count = 0;
  std::vector<LabelledVoxelSums> entries;
  for (std::size_t place = 0; place < message.size();) {
    const auto header = take<TileHeader>(message, place);
    const Eigen::Vector3i tile(header.coordinate[0].value(), header.coordinate[1].value(),
                               header.coordinate[2].value());
    for (std::uint32_t i = 0; i < header.entry_count.value(); ++i) {
      entries.push_back(decodeEntry(take<MapEntryLayout>(message, place), tile));
      origin.point_count += entries.back().sums.count;
    }
  }
  owned.merge(WeightedVoxelMap(origin, std::move(entries)));
}

}  // namespace saw_ndt::internal
