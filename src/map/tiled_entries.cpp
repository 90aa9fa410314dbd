#include "map/tiled_entries.h"

#include <algorithm>
#include <numeric>
#include <unordered_map>

#include "map/map_tile.h"
#include "map/merge_rules.h"

namespace saw_ndt::internal {
namespace {

/// Numbers tiles in the order in which they are met.
class TileNumbers {
 public:
  std::uint32_t of(const Eigen::Vector3i& tile) {
    // Entries that were met one after the other often share their tile.
    if (coordinates_.empty() || tile != coordinates_[last_]) {
      const auto [found, is_new] = numbers_.emplace(tile, static_cast<std::uint32_t>(coordinates_.size()));
      if (is_new) coordinates_.push_back(tile);
      last_ = found->second;
    }
    return last_;
  }
  const std::vector<Eigen::Vector3i>& coordinates() const { return coordinates_; }

 private:
  struct Hash {
    std::size_t operator()(const Eigen::Vector3i& tile) const { return hashCoordinate(tile); }
  };

  std::unordered_map<Eigen::Vector3i, std::uint32_t, Hash> numbers_;
  std::vector<Eigen::Vector3i> coordinates_;
  std::uint32_t last_ = 0;
};

// Calls visit(tile) for every entry of a table.
template <typename Visit>
void forEachEntryTile(const VoxelSumsTable& table, const Visit& visit) {
  table.forEachBatch([&](const std::vector<LabelledVoxelSums>& entries) {
    for (const LabelledVoxelSums& entry : entries) visit(tileOf(entry.voxel));
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

// Adds up the entries of one voxel and label, of which there may be several.
void addUp(std::vector<LabelledVoxelSums>& entries) {
  std::sort(entries.begin(), entries.end(),
            [](const LabelledVoxelSums& a, const LabelledVoxelSums& b) { return keyWithinTile(a) < keyWithinTile(b); });
  std::size_t last = 0;
  for (std::size_t i = 1; i < entries.size(); ++i) {
    LabelledVoxelSums& into = entries[last];
    if (entries[i].voxel == into.voxel && entries[i].label == into.label) {
      requireRoomFor(entries[i].sums, into.sums);
      addScanCount(entries[i], into);
      into.sums += entries[i].sums;
    } else {
      entries[++last] = entries[i];
    }
  }
  if (!entries.empty()) entries.resize(last + 1);
}

}  // namespace

TiledEntries::TiledEntries(const VoxelSumsTable& table, const SpilledTiles* spilled)
    : table_(table), spilled_(spilled), places_(table.size()), parts_(spilled ? spilled->parts().size() : 0) {
  TileNumbers numbers;
  std::vector<std::size_t> entry_counts, part_counts;  // by number of the tile
  const auto count = [&](const Eigen::Vector3i& tile, std::vector<std::size_t>& counts) {
    const std::uint32_t number = numbers.of(tile);
    counts.resize(std::max<std::size_t>(counts.size(), number + std::size_t{1}));
    ++counts[number];
  };
  forEachEntryTile(table, [&](const Eigen::Vector3i& tile) { count(tile, entry_counts); });
  for (std::size_t part = 0; part < parts_.size(); ++part) count(spilled->parts()[part].coordinate, part_counts);
  entry_counts.resize(numbers.coordinates().size());
  part_counts.resize(numbers.coordinates().size());

  std::vector<std::uint32_t> in_order(numbers.coordinates().size());
  std::iota(in_order.begin(), in_order.end(), std::uint32_t{0});
  std::sort(in_order.begin(), in_order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return tileInMapOrder(numbers.coordinates()[a], numbers.coordinates()[b]);
  });
  std::vector<std::size_t> next_places(in_order.size()), next_parts(in_order.size());
  std::size_t place = 0, part = 0;
  tiles_.reserve(in_order.size());
  for (const std::uint32_t number : in_order) {
    next_places[number] = place;
    next_parts[number] = part;
    place += entry_counts[number];
    part += part_counts[number];
    tiles_.push_back({numbers.coordinates()[number], next_places[number], place, next_parts[number], part});
  }
  std::uint32_t i = 0;
  forEachEntryTile(table, [&](const Eigen::Vector3i& tile) { places_[next_places[numbers.of(tile)]++] = i++; });
  for (std::uint32_t k = 0; k < parts_.size(); ++k) {
    parts_[next_parts[numbers.of(spilled->parts()[k].coordinate)]++] = k;
  }
}

std::uint64_t TiledEntries::entryCount(std::size_t tile) const {
  std::uint64_t count = tiles_[tile].end_place - tiles_[tile].first_place;
  for (std::size_t i = tiles_[tile].first_part; i < tiles_[tile].end_part; ++i) {
    count += spilled_->parts()[parts_[i]].entry_count;
  }
  return count;
}

void TiledEntries::read(std::size_t tile, std::vector<LabelledVoxelSums>& entries) const {
  const Tile& read = tiles_[tile];
  entries.clear();
  entries.reserve(entryCount(tile));
  for (std::size_t i = read.first_part; i < read.end_part; ++i) spilled_->read(spilled_->parts()[parts_[i]], entries);
  // Key and place as one number.
  std::vector<std::uint64_t> order;
  order.reserve(read.end_place - read.first_place);
  for (std::size_t i = read.first_place; i < read.end_place; ++i) {
    order.push_back(std::uint64_t{keyWithinTile(table_.entry(places_[i]))} << 32U | places_[i]);
  }
  std::sort(order.begin(), order.end());
  for (const std::uint64_t item : order) entries.push_back(table_.entry(static_cast<std::uint32_t>(item)));
  if (read.end_part - read.first_part + (order.empty() ? 0 : 1) > 1) addUp(entries);
}

void forEachTileOf(const VoxelSumsTable& table, const SpilledTiles* spilled,
                   const std::function<void(const std::vector<LabelledVoxelSums>& entries)>& visit, int threads) {
  const TiledEntries tiles(table, spilled);
  tiles.forEach<std::vector<LabelledVoxelSums>>(
      threads,
      [](std::vector<LabelledVoxelSums>& entries, std::vector<LabelledVoxelSums>& result) { result.swap(entries); },
      visit);
}

}  // namespace saw_ndt::internal
