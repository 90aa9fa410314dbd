#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "saw_ndt/map/voxel_sums.h"

namespace saw_ndt::internal {

/// Where more scans met a voxel, this is told: map files have room for it.
constexpr std::uint32_t kMostScansOfVoxel = (1U << 24U) - 1;

/// A well-mixed hash of three voxel or brick coordinates.
inline std::uint64_t hashCoordinate(const Eigen::Vector3i& c) {
  std::uint64_t h = static_cast<std::uint32_t>(c.x()) * 0x9E3779B97F4A7C15ull;
  h = (h ^ (h >> 32) ^ static_cast<std::uint32_t>(c.y())) * 0xC2B2AE3D27D4EB4Full;
  h = (h ^ (h >> 29) ^ static_cast<std::uint32_t>(c.z())) * 0x165667B19E3779F9ull;
  return h ^ (h >> 32);
}

/// Sums by voxel and label: a hash table of 8-byte slots that point into chunks of entries. A slot holds the hash too,
/// so that looking for one entry rarely touches another. Entries never move: a table that grows takes the memory of one
/// more chunk, not of a second copy.
class VoxelSumsTable {
 public:
  VoxelSumsTable() : slots_(kMinSlots) {}
  VoxelSumsTable(const VoxelSumsTable& other) { *this = other; }
  VoxelSumsTable& operator=(const VoxelSumsTable& other) {
    slots_ = other.slots_;
    chunks_.clear();
    for (const Chunk& chunk : other.chunks_) {
      Chunk& copy = newChunk();
      copy.entries.insert(copy.entries.end(), chunk.entries.begin(), chunk.entries.end());
      copy.last_scan.insert(copy.last_scan.end(), chunk.last_scan.begin(), chunk.last_scan.end());
    }
    return *this;
  }
  VoxelSumsTable(VoxelSumsTable&&) noexcept = default;
  VoxelSumsTable& operator=(VoxelSumsTable&&) noexcept = default;

  /// How many entries there are. Their places are 0 to size() - 1, in the order in which their voxels were first met.
  std::size_t size() const {
    return chunks_.empty() ? 0 : (chunks_.size() - 1) * kChunk + chunks_.back().entries.size();
  }

  /// The entry of `label` in `voxel`; null where there is none.
  const LabelledVoxelSums* find(const VoxelCoordinate& voxel, StructuralLabel label) const {
    const Slot& slot = slots_[slotOf(voxel, label, hashOf(voxel, label))];
    return slot.place == kEmpty ? nullptr : &entry(slot.place);
  }

  /// The place of the entry of `label` in `voxel`, which is made empty where there is none yet.
  std::size_t placeOf(const VoxelCoordinate& voxel, StructuralLabel label) {
    const std::uint32_t hash = hashOf(voxel, label);
    const std::size_t slot = slotOf(voxel, label, hash);
    if (slots_[slot].place != kEmpty) return slots_[slot].place;
    const std::size_t place = size();
    slots_[slot] = {hash, static_cast<std::uint32_t>(place)};
    Chunk& chunk = place % kChunk == 0 ? newChunk() : chunks_.back();
    chunk.entries.push_back({voxel, label, {}, 0});
    chunk.last_scan.push_back(0);
    if (2 * (place + 1) > slots_.size()) grow();
    return place;
  }

  LabelledVoxelSums& entry(std::size_t place) { return chunks_[place / kChunk].entries[place % kChunk]; }
  const LabelledVoxelSums& entry(std::size_t place) const { return chunks_[place / kChunk].entries[place % kChunk]; }

  /// Counts a scan, by its number from 1 on, towards the entry at a place, once however often it is told; to be called
  /// before the scan's points are added. Where the scans of points before are not known, it stays so.
  void meet(std::size_t place, std::uint32_t scan) {
    std::uint32_t& last_scan = chunks_[place / kChunk].last_scan[place % kChunk];
    if (last_scan == scan) return;
    last_scan = scan;
    LabelledVoxelSums& met = entry(place);
    if (met.scan_count != 0 || met.sums.count == 0) ++met.scan_count;
  }

  /// Adds other sums; calls count_scans(entry of the other, entry here before its sums are added, its place) for each.
  template <typename CountScans>
  void add(const std::vector<LabelledVoxelSums>& others, const CountScans& count_scans) {
    for (const LabelledVoxelSums& from : others) {
      const std::size_t place = placeOf(from.voxel, from.label);
      LabelledVoxelSums& into = entry(place);
      count_scans(from, into, place);
      into.sums += from.sums;
    }
  }
  template <typename CountScans>
  void add(const VoxelSumsTable& other, const CountScans& count_scans) {
    other.forEachBatch([&](const std::vector<LabelledVoxelSums>& entries) { add(entries, count_scans); });
  }

  /// Calls visit(entries) for all entries, some at a time, in the order of their places.
  template <typename Visit>
  void forEachBatch(const Visit& visit) const {
    for (const Chunk& chunk : chunks_) visit(chunk.entries);
  }

  /// All entries in that order, moved out chunk by chunk. The table is empty afterwards.
  std::vector<LabelledVoxelSums> takeEntries() {
    std::vector<LabelledVoxelSums> all;
    all.reserve(size());
    for (Chunk& chunk : chunks_) {
      all.insert(all.end(), chunk.entries.begin(), chunk.entries.end());
      chunk = {};
    }
    clear();
    return all;
  }
  void clear() {
    slots_ = std::vector<Slot>(kMinSlots);
    chunks_.clear();
  }

 private:
  static constexpr std::size_t kMinSlots = 1024;  // a power of two
  static constexpr std::size_t kChunk = 4096;     // entries; 400 kB, which become the process's as they are used
  static constexpr std::uint32_t kEmpty = 0xFFFFFFFFu;

  struct Slot {
    std::uint32_t hash = 0;
    std::uint32_t place = kEmpty;
  };
  struct Chunk {
    std::vector<LabelledVoxelSums> entries;
    std::vector<std::uint32_t> last_scan;  // that met each
  };

  static std::uint32_t hashOf(const VoxelCoordinate& voxel, StructuralLabel label) {
    return static_cast<std::uint32_t>(hashCoordinate(voxel)) + static_cast<std::uint32_t>(label) * 0x9E3779B9u;
  }
  std::size_t mask() const { return slots_.size() - 1; }

  // Of the entry, or the empty one for it.
  std::size_t slotOf(const VoxelCoordinate& voxel, StructuralLabel label, std::uint32_t hash) const {
    std::size_t slot = hash & mask();
    for (; slots_[slot].place != kEmpty; slot = (slot + 1) & mask()) {
      if (slots_[slot].hash != hash) continue;
      const LabelledVoxelSums& met = entry(slots_[slot].place);
      if (met.voxel == voxel && met.label == label) break;
    }
    return slot;
  }

  Chunk& newChunk() {
    Chunk& chunk = chunks_.emplace_back();
    chunk.entries.reserve(kChunk);
    chunk.last_scan.reserve(kChunk);
    return chunk;
  }

  void grow() {
    std::vector<Slot> old(2 * slots_.size());
    old.swap(slots_);
    for (const Slot& moved : old) {
      if (moved.place == kEmpty) continue;
      std::size_t slot = moved.hash & mask();
      while (slots_[slot].place != kEmpty) slot = (slot + 1) & mask();
      slots_[slot] = moved;
    }
  }

  std::vector<Slot> slots_;
  std::vector<Chunk> chunks_;
};

}  // namespace saw_ndt::internal
