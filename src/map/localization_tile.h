#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "map/ndt_level.h"
#include "map/quantized_cell.h"
#include "saw_ndt/common/export.h"
#include "saw_ndt/map/voxel_statistics.h"

namespace saw_ndt::internal {

/// Edge of the square tiles that a localization map is cut into, of unbounded height (m).
constexpr double kLocalizationTile_m = 64.0;

/// Which tile: x and y in tiles.
struct TileCoordinate {
  int x = 0;
  int y = 0;

  friend bool operator==(const TileCoordinate& a, const TileCoordinate& b) { return a.x == b.x && a.y == b.y; }
  /// The order of a localization map.
  friend bool operator<(const TileCoordinate& a, const TileCoordinate& b) {
    return std::pair(a.y, a.x) < std::pair(b.y, b.x);
  }
};

/// How far a localization map reaches (m): numbers of columns of a metre and of tiles are 32-bit integers.
constexpr double kFarthestTile_m = 1.5e7 * kLocalizationTile_m;
/// Whether a tile lies within that, and so near that its voxels can be numbered as well.
bool isWithinReach(const TileCoordinate& tile, double resolution_m);

/// The tile that holds the centre of a voxel.
TileCoordinate localizationTileOf(const VoxelCoordinate& voxel, double resolution_m);
/// The tile that holds a position (m). @pre less than 1e9 m away
TileCoordinate localizationTileAt(double x_m, double y_m);

/// Voxels are left out whose middle is farther than that from a place, horizontally (m).
struct LocalizationClip {
  Eigen::Vector2d centre_m = Eigen::Vector2d::Zero();
  double radius_m = std::numeric_limits<double>::infinity();
};

/// The voxels of one level in a tile.
struct TileLevel {
  std::vector<VoxelCoordinate> voxels;
  std::vector<QuantizedCell> cells;  ///< whose places are set when they are encoded
};

/// One tile of a localization map, level after level.
struct LocalizationTile {
  TileCoordinate at;
  std::vector<TileLevel> levels;

  /// Adds a voxel that belongs to the tile to a level whose voxels have that edge.
  void add(std::size_t level, const VoxelStatistics& statistics, double resolution_m);
  std::size_t cellCount() const;
};

/// The bytes of a tile: for each level u32 cells and i32 least z, then the cells level after level, those of a level by
/// bricks of 8 x 8 x 8, in which VoxelIndex has them.
/// @param resolutions_m  of each level
/// @throws std::length_error where the voxels of a level lie 65,536 or more above each other
std::string encodedTile(const LocalizationTile& tile, const std::vector<double>& resolutions_m);

/// Appends the cells of a tile to those of its levels, in the arrangement of a target: the matching levels, then the
/// coarse one where there is one.
/// @param resolutions_m  of each level
/// @return false where the bytes are no such tile; nothing is to be used then
bool appendDecodedTile(const char* bytes, std::size_t size, const TileCoordinate& at,
                       const std::vector<double>& resolutions_m, const VoxelWeighting& weighting,
                       const LocalizationClip& clip, std::vector<NdtCells>& cells);

/// Calls visit(level, cell) for each cell of such a tile, level after level. @return false as above
bool forEachCell(const char* bytes, std::size_t size, const TileCoordinate& at,
                 const std::vector<double>& resolutions_m,
                 const std::function<void(std::size_t level, const QuantizedCell& cell)>& visit);

}  // namespace saw_ndt::internal
