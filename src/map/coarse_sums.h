#pragma once

#include <vector>

#include "map/voxel_sums_table.h"

namespace saw_ndt::internal {

/// The sums of coarse voxels, by label; of the scans that met a coarse voxel, those that met one of its fine ones, the
/// most met one. Addition is exact: fine voxels may come in any order and in parts.
class CoarseSums {
 public:
  /// @param factor  edge of a coarse voxel in fine ones, 2 or more
  explicit CoarseSums(int factor) : factor_(factor) {}

  /// Adds fine entries, the entries of a voxel one after the other; fastest in map order.
  void add(const LabelledVoxelSums* first, const LabelledVoxelSums* last);
  void add(const CoarseSums& other);

  /// All that has been added, in map order. Nothing is left behind.
  std::vector<LabelledVoxelSums> takeInMapOrder();

 private:
  int factor_;
  VoxelSumsTable table_;
};

}  // namespace saw_ndt::internal
