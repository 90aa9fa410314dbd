#include "map/tiled_entries.h"

#include <algorithm>
#include <numeric>
#include <unordered_map>

#include "map/map_tile.h"

namespace saw_ndt::internal {
namespace {

struct TileHash {
  std::size_t operator()(const Eigen::Vector3i& tile) const { return hashCoordinate(tile); }
};

// Calls visit(number of the tile) for each entry; a tile that has not been met before is given the next number.
template <typename Visit>
void forEachTileNumber(const VoxelSumsTable& table,
                       std::unordered_map<Eigen::Vector3i, std::uint32_t, TileHash>& numbers, const Visit& visit) {
  // Entries that were met one after the other often share their tile.
  Eigen::Vector3i last_tile = Eigen::Vector3i::Zero();
  std::uint32_t last_number = 0;
  bool any = false;
  table.forEachBatch([&](const std::vector<LabelledVoxelSums>& entries) {
    for (const LabelledVoxelSums& entry : entries) {
      const Eigen::Vector3i tile = tileOf(entry.voxel);
      if (!any || tile != last_tile) {
        last_number = numbers.emplace(tile, static_cast<std::uint32_t>(numbers.size())).first->second;
        last_tile = tile;
        any = true;
      }
      visit(last_number, tile);
    }
  });
}

std::uint32_t keyWithinTile(const LabelledVoxelSums& entry) {
  constexpr int kLabelBits = 2;
  static_assert(kStructuralLabelCount <= 1 << kLabelBits);
  constexpr int kMask = kTileSize - 1;
  const auto x = static_cast<std::uint32_t>(entry.voxel.x() & kMask);
  const auto y = static_cast<std::uint32_t>(entry.voxel.y() & kMask);
  const auto z = static_cast<std::uint32_t>(entry.voxel.z() & kMask);
  return (((((z << kTileBits) | y) << kTileBits) | x) << kLabelBits) | static_cast<std::uint32_t>(entry.label);
}

}  // namespace

TiledEntries::TiledEntries(const VoxelSumsTable& table) : table_(table), places_(table.size()) {
  std::unordered_map<Eigen::Vector3i, std::uint32_t, TileHash> numbers;
  std::vector<Tile> met;  // by number; `end` counts
  forEachTileNumber(table, numbers, [&](std::uint32_t number, const Eigen::Vector3i& tile) {
    if (number == met.size()) met.push_back({tile, 0, 0});
    ++met[number].end;
  });
  std::vector<std::uint32_t> in_order(met.size());
  std::iota(in_order.begin(), in_order.end(), std::uint32_t{0});
  std::sort(in_order.begin(), in_order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return tileInMapOrder(met[a].coordinate, met[b].coordinate); });
  std::size_t first = 0;
  for (const std::uint32_t number : in_order) {
    const std::size_t count = met[number].end;
    met[number].first = met[number].end = first;
    first += count;
  }
  std::uint32_t place = 0;
  forEachTileNumber(table, numbers,
                    [&](std::uint32_t number, const Eigen::Vector3i&) { places_[met[number].end++] = place++; });
  tiles_.reserve(met.size());
  for (const std::uint32_t number : in_order) tiles_.push_back(met[number]);
}

void TiledEntries::read(std::size_t tile, std::vector<LabelledVoxelSums>& entries) const {
  // Key and place as one number.
  std::vector<std::uint64_t> order;
  order.reserve(entryCount(tile));
  for (std::size_t i = tiles_[tile].first; i < tiles_[tile].end; ++i) {
    order.push_back(std::uint64_t{keyWithinTile(table_.entry(places_[i]))} << 32 | places_[i]);
  }
  std::sort(order.begin(), order.end());
  entries.clear();
  entries.reserve(order.size());
  for (const std::uint64_t item : order) entries.push_back(table_.entry(static_cast<std::uint32_t>(item)));
}

}  // namespace saw_ndt::internal
