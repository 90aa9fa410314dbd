#pragma once

#include <cstdint>
#include <vector>

#include "map/map_file.h"
#include "saw_ndt/map/map_region.h"

namespace saw_ndt::internal {

/// The middle of a voxel in the map frame (m).
inline Eigen::Vector3d centreOf(const VoxelCoordinate& voxel, double resolution_m) {
  return (voxel.cast<double>().array() + 0.5).matrix() * resolution_m;
}

/// Calls visit(entry) for the entries whose voxels' centres belong to a region, in their order.
/// @param first, last  entries that hold those of a voxel one after the other
template <typename Visit>
void forEachEntryIn(const MapRegion& region, double resolution_m, const LabelledVoxelSums* first,
                    const LabelledVoxelSums* last, const Visit& visit) {
  bool belongs = false;
  for (const LabelledVoxelSums* entry = first; entry != last; ++entry) {
    if (entry == first || entry->voxel != entry[-1].voxel) belongs = region(centreOf(entry->voxel, resolution_m));
    if (belongs) visit(*entry);
  }
}

/// A tile to be looked at, see forEachTileInBatches().
struct RegionTile {
  std::uint64_t place = 0;  ///< in the directory
  std::uint64_t byte_count = 0;
};

/// Finds the tiles of a map file that can meet a region.
class RegionTiles {
 public:
  /// Both must live as long as this.
  RegionTiles(const MapFileReader& reader, const MapRegion& region) : reader_(reader), region_(region) {}

  /// The next one in map order; false behind the last one.
  bool next(RegionTile& tile);

 private:
  const MapFileReader& reader_;
  const MapRegion& region_;
  std::uint64_t next_ = 0;
};

/// Replaces `entries` by those of a tile whose voxels' centres belong, and gives the tile's memory back. May be called
/// by several threads at a time.
/// @param scratch  for all entries of the tile
void decodeTileIn(MapFileReader& reader, std::uint64_t place, const MapRegion& region,
                  std::vector<LabelledVoxelSums>& scratch, std::vector<LabelledVoxelSums>& entries);

}  // namespace saw_ndt::internal
