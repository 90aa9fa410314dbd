#pragma once

#include <cstddef>
#include <vector>

#include "saw_ndt/map/weighted_map_builder.h"

namespace saw_ndt::internal {

/// The rank that keeps a tile, by a hash of its coordinate: neighbours, which are busy at the same time, go to
/// different ranks.
int ownerOfTile(const Eigen::Vector3i& tile, int rank_count);

/// Sums on their way to the ranks that own their tiles: for each rank, messages of some 16 MB. A message is tile after
/// tile: i32 x y z, u32 entries, then the entries as in the map file (see map_file.h).
std::vector<std::vector<std::vector<char>>> messagesByOwner(const WeightedMapBuilder& collected, int rank_count);

/// Adds what a message holds to a builder of the same resolution and segmentation, but for the number of scans of the
/// map. @throws std::invalid_argument as WeightedMapBuilder::merge(), and for what is no such message
void addMessage(const std::vector<char>& message, WeightedMapBuilder& owned);

}  // namespace saw_ndt::internal
