#pragma once

#include <cstdint>
#include <utility>
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

/// Sums by voxel and label: a hash table of 8-byte slots that point into a flat array of entries. A slot holds the hash
/// too, so that looking for one entry rarely touches another.
class VoxelSumsTable {
 public:
  VoxelSumsTable() : slots_(kMinSlots) {}

  /// The entry of `label` in `voxel`; null where there is none.
  const LabelledVoxelSums* find(const VoxelCoordinate& voxel, StructuralLabel label) const {
    const Slot& slot = slots_[slotOf(voxel, label, hashOf(voxel, label))];
    return slot.place == kEmpty ? nullptr : &entries_[slot.place];
  }

  /// The place in entries() of `label` in `voxel`, made empty where there is none yet.
  std::size_t placeOf(const VoxelCoordinate& voxel, StructuralLabel label) {
    const std::uint32_t hash = hashOf(voxel, label);
    const std::size_t slot = slotOf(voxel, label, hash);
    if (slots_[slot].place != kEmpty) return slots_[slot].place;
    const std::size_t place = entries_.size();
    slots_[slot] = {hash, static_cast<std::uint32_t>(place)};
    entries_.push_back({voxel, label, {}, 0});
    last_scan_.push_back(0);
    if (2 * (place + 1) > slots_.size()) grow();
    return place;
  }

  /// The sums at a place in entries().
  VoxelSums& sums(std::size_t place) { return entries_[place].sums; }

  LabelledVoxelSums& entry(std::size_t place) { return entries_[place]; }
  /// Counts a scan, by its number from 1 on, towards the entry at a place, once however often it is told; to be called
  /// before the scan's points are added. Where the scans of points before are not known, it stays so.
  void meet(std::size_t place, std::uint32_t scan) {
    if (last_scan_[place] == scan) return;
    last_scan_[place] = scan;
    LabelledVoxelSums& entry = entries_[place];
    if (entry.scan_count != 0 || entry.sums.count == 0) ++entry.scan_count;
  }

  /// Adds other sums; calls count_scans(entry of the other, entry here before its sums are added, its place) for each.
  template <typename CountScans>
  void add(const std::vector<LabelledVoxelSums>& others, const CountScans& count_scans) {
    for (const LabelledVoxelSums& from : others) {
      const std::size_t place = placeOf(from.voxel, from.label);
      count_scans(from, entries_[place], place);
      entries_[place].sums += from.sums;
    }
  }

  /// The entries in the order in which their voxels were first met.
  const std::vector<LabelledVoxelSums>& entries() const { return entries_; }
  /// The same, moved out. The table is empty afterwards.
  std::vector<LabelledVoxelSums> takeEntries() {
    slots_ = std::vector<Slot>(kMinSlots);
    last_scan_.clear();
    return std::exchange(entries_, {});
  }

 private:
  static constexpr std::size_t kMinSlots = 1024;  // a power of two
  static constexpr std::uint32_t kEmpty = 0xFFFFFFFFu;

  struct Slot {
    std::uint32_t hash = 0;
    std::uint32_t place = kEmpty;
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
      const LabelledVoxelSums& entry = entries_[slots_[slot].place];
      if (entry.voxel == voxel && entry.label == label) break;
    }
    return slot;
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
  std::vector<LabelledVoxelSums> entries_;
  std::vector<std::uint32_t> last_scan_;  // that met each entry
};

}  // namespace saw_ndt::internal
