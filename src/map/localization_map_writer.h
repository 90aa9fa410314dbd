#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "common/atomic_output.h"
#include "map/localization_map_layout.h"
#include "map/localization_tile.h"
#include "saw_ndt/map/weighted_voxel_map.h"

namespace saw_ndt::internal {

/// A tile as it stands in a localization map.
struct PackedTile {
  TileCoordinate at;
  std::string cells;  ///< see encodedTile()
  std::string table;  ///< see encodedPlaceTile(); empty where nothing stands
  std::uint64_t voxel_count = 0;
  std::uint64_t coarse_voxel_count = 0;
};

/// Writes a localization map (see localization_map_layout.h): its tiles as they come, and in the end what lies before
/// and behind them. Without finish() nothing is left behind.
class SAW_NDT_EXPORT LocalizationMapWriter {
 public:
  /// @throws Error where the file cannot be written
  LocalizationMapWriter(const std::string& path, const MapOrigin& origin, const VoxelWeighting& weighting);

  /// Each tile once, in any order.
  void add(const PackedTile& tile);
  /// @throws Error where not everything could be written
  void finish();

 private:
  void writeExtent(LocalizationMapHeader& header) const;

  MapOrigin origin_;
  std::string metadata_;
  AtomicOutput output_;
  std::map<TileCoordinate, LocalizationTileRecord> directory_;
  std::uint64_t offset_ = 0;
  std::uint64_t voxel_count_ = 0;
  std::uint64_t coarse_voxel_count_ = 0;
};

}  // namespace saw_ndt::internal
