#pragma once

#include <cstdint>
#include <vector>

#include "saw_ndt/map/voxel_sums.h"

namespace saw_ndt {

/// A well-mixed hash of three voxel or brick coordinates.
inline std::uint64_t hashCoordinate(const Eigen::Vector3i& c) {
  std::uint64_t h = static_cast<std::uint32_t>(c.x()) * 0x9E3779B97F4A7C15ull;
  h = (h ^ (h >> 32) ^ static_cast<std::uint32_t>(c.y())) * 0xC2B2AE3D27D4EB4Full;
  h = (h ^ (h >> 29) ^ static_cast<std::uint32_t>(c.z())) * 0x165667B19E3779F9ull;
  return h ^ (h >> 32);
}

/// Sums by voxel and label: a hash table of 4-byte slots that point into a flat array of entries.
class VoxelSumsTable {
 public:
  VoxelSumsTable() : slots_(kLeastSlots, kEmpty) {}

  /// The sums of `label` in `voxel`, made empty where there are none yet. Valid until the next call.
  VoxelSums& at(const VoxelCoordinate& voxel, StructuralLabel label) {
    std::size_t slot = find(voxel, label);
    if (slots_[slot] == kEmpty) {
      if (2 * (entries_.size() + 1) > slots_.size()) {
        grow();
        slot = find(voxel, label);
      }
      slots_[slot] = static_cast<std::uint32_t>(entries_.size());
      entries_.push_back({voxel, label, {}});
    }
    return entries_[slots_[slot]].sums;
  }

  void add(const LabelledVoxelSums& entry) { at(entry.voxel, entry.label) += entry.sums; }
  void add(const VoxelSumsTable& other) {
    for (const LabelledVoxelSums& entry : other.entries_) add(entry);
  }

  /// The entries in the order in which their voxels were first met.
  const std::vector<LabelledVoxelSums>& entries() const { return entries_; }

 private:
  static constexpr std::size_t kLeastSlots = 1024;  // a power of two
  static constexpr std::uint32_t kEmpty = 0xFFFFFFFFu;

  std::size_t find(const VoxelCoordinate& voxel, StructuralLabel label) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = (hashCoordinate(voxel) + static_cast<std::uint32_t>(label) * 0x9E3779B9u) & mask;
    while (slots_[slot] != kEmpty) {
      const LabelledVoxelSums& entry = entries_[slots_[slot]];
      if (entry.voxel == voxel && entry.label == label) break;
      slot = (slot + 1) & mask;
    }
    return slot;
  }

  void grow() {
    slots_.assign(2 * slots_.size(), kEmpty);
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      slots_[find(entries_[i].voxel, entries_[i].label)] = static_cast<std::uint32_t>(i);
    }
  }

  std::vector<std::uint32_t> slots_;
  std::vector<LabelledVoxelSums> entries_;
};

}  // namespace saw_ndt
