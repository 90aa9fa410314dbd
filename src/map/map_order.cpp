#include "map/map_order.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "map/map_tile.h"

namespace saw_ndt::internal {
namespace {

struct Key {
  std::uint64_t value;  // ascends in map order
  std::uint32_t entry;
};

int bitsOf(std::uint64_t range) {
  int bits = 0;
  for (; range != 0; range >>= 1) ++bits;
  return bits;
}

// Tile, voxel within it and label as one number; nothing where the tiles lie too far apart for 64 bits.
std::vector<Key> keysOf(const std::vector<LabelledVoxelSums>& entries) {
  Eigen::Vector3i least = tileOf(entries.front().voxel), most = least;
  for (const LabelledVoxelSums& entry : entries) {
    const Eigen::Vector3i tile = tileOf(entry.voxel);
    least = least.cwiseMin(tile);
    most = most.cwiseMax(tile);
  }
  const Eigen::Vector3i range = most - least;
  const int x_bits = bitsOf(static_cast<std::uint64_t>(range.x()));
  const int y_bits = bitsOf(static_cast<std::uint64_t>(range.y()));
  constexpr int kLabelBits = 2, kBitsWithinTile = 3 * kTileBits + kLabelBits;
  static_assert(kStructuralLabelCount <= 1 << kLabelBits);
  std::vector<Key> keys;
  if (x_bits + y_bits + bitsOf(static_cast<std::uint64_t>(range.z())) + kBitsWithinTile > 64) return keys;
  keys.reserve(entries.size());
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const VoxelCoordinate& voxel = entries[i].voxel;
    const auto tile = (tileOf(voxel) - least).cast<std::uint64_t>().eval();
    const auto local = (voxel - tileOf(voxel) * kTileSize).cast<std::uint64_t>().eval();
    std::uint64_t key = (((tile.z() << y_bits) | tile.y()) << x_bits) | tile.x();
    key = (((((key << kTileBits) | local.z()) << kTileBits) | local.y()) << kTileBits) | local.x();
    keys.push_back({(key << kLabelBits) | static_cast<std::uint64_t>(entries[i].label), static_cast<std::uint32_t>(i)});
  }
  return keys;
}

// By one byte after the other, the last one first, in passes that keep the order of the pass before.
void sortKeys(std::vector<Key>& keys) {
  constexpr std::size_t kBytes = sizeof(std::uint64_t);
  std::array<std::array<std::uint32_t, 256>, kBytes> counts{};
  for (const Key& key : keys) {
    for (std::size_t byte = 0; byte < kBytes; ++byte) ++counts[byte][(key.value >> (8 * byte)) & 0xFF];
  }
  std::vector<Key> sorted(keys.size());
  for (std::size_t byte = 0; byte < kBytes; ++byte) {
    const std::size_t shift = 8 * byte;
    if (counts[byte][(keys.front().value >> shift) & 0xFF] == keys.size()) continue;
    std::uint32_t start = 0;
    for (std::uint32_t& count : counts[byte]) {
      const std::uint32_t next = start + count;
      count = start;
      start = next;
    }
    for (const Key& key : keys) sorted[counts[byte][(key.value >> shift) & 0xFF]++] = key;
    keys.swap(sorted);
  }
}

// Puts the entry that each key names in the key's place, cycle by cycle: without a second copy of a whole map.
void moveInto(std::vector<Key>& keys, std::vector<LabelledVoxelSums>& entries) {
  for (std::uint32_t start = 0; start < keys.size(); ++start) {
    if (keys[start].entry == start) continue;
    const LabelledVoxelSums first = entries[start];
    std::uint32_t place = start;
    while (keys[place].entry != start) {
      const std::uint32_t from = keys[place].entry;
      entries[place] = entries[from];
      keys[place].entry = place;
      place = from;
    }
    entries[place] = first;
    keys[place].entry = place;
  }
}

}  // namespace

void sortIntoMapOrder(std::vector<LabelledVoxelSums>& entries) {
  if (entries.empty()) return;
  std::vector<Key> keys = keysOf(entries);
  if (keys.empty()) {
    std::sort(entries.begin(), entries.end(), inMapOrder);
    return;
  }
  sortKeys(keys);
  moveInto(keys, entries);
}

}  // namespace saw_ndt::internal
