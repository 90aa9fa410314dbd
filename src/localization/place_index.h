#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "localization/place_index_loops.h"
#include "saw_ndt/map/ndt_target.h"

namespace saw_ndt::internal {

/// Edge of a column of the index, and height of its layers (m).
constexpr double kColumn_m = 1.0;

/// A column: x and y in units of kColumn_m, rounded down.
struct Column {
  int x = 0;
  int y = 0;
};

/// The column of a point (m), less than 1e9 m away.
Column columnOf(const Eigen::Vector3d& point);
/// The layer of something so high above the ground (m); nothing where it is below the lowest or above the highest.
std::optional<int> layerOf(double height_m);

/// The height of the ground under columns, where it has been seen and outward from there.
class GroundHeights {
 public:
  static constexpr std::uint8_t kUnknown = 255;

  /// Adds a point of ground (m), less than 1e9 m away.
  void add(const Eigen::Vector3d& point);
  /// Gives columns that are at most so many steps from seen ground the height of the nearest; fewer than kUnknown.
  void spread(int steps);

  /// The tiles in which ground is known.
  std::vector<Column> tiles() const;
  /// Of the ground under a column (m); nothing where it is not known.
  std::optional<float> at(const Column& column) const;
  /// How many steps a column is from seen ground, or kUnknown.
  std::uint8_t stepsToSeen(const Column& column) const;

 private:
  struct Tile {
    std::array<float, kPlaceTileSize * kPlaceTileSize> height_m{};  // the lowest of each column, before spread()
    std::array<std::uint8_t, kPlaceTileSize * kPlaceTileSize> steps;
    Tile() { steps.fill(kUnknown); }
  };

  std::unordered_map<std::uint64_t, Tile> tiles_;
};

/// Of points that may be ground, those no more than that above the lowest within some 6 m.
std::vector<Eigen::Vector3d> lowestOf(const std::vector<Eigen::Vector3d>& points, double most_height_m);

/// What stands where in a map, by height above the ground: bits, for each column of 1 m and each of 32 layers, and the
/// columns in which a vehicle may stand. It is what a scan is looked up in when nobody knows where it was taken.
class PlaceIndex {
 public:
  struct Tile {
    Column at;  ///< in tiles
    std::array<std::uint64_t, kPlaceTileWords> words{};
    std::array<std::uint64_t, kPlaceTileSize> allowed{};  ///< a bit for each column in which a vehicle may stand
    std::array<float, kPlaceTileSize * kPlaceTileSize> ground_m{};  ///< its ground, row by row

    bool hasStanding() const;  ///< whether a vehicle may stand anywhere
  };

  explicit PlaceIndex(const NdtTarget& target);
  /// Of tiles of another index, each once, such as come from a localization map; all but their repeated rows are read.
  explicit PlaceIndex(std::vector<Tile> tiles);

  /// Those in which a vehicle may stand come first.
  const std::vector<Tile>& tiles() const { return tiles_; }
  /// How many tiles have a column in which a vehicle may stand.
  std::size_t standingTileCount() const { return standing_tile_count_; }
  /// A tile and its neighbours.
  PlaceTables tablesAround(const Tile& tile) const;

 private:
  void arrange();

  std::vector<Tile> tiles_;
  std::unordered_map<std::uint64_t, std::size_t> tile_numbers_;
  std::size_t standing_tile_count_ = 0;
};

}  // namespace saw_ndt::internal
