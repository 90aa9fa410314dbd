#include "localization/place_index.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "map/ndt_level.h"
#include "saw_ndt/registration/source_points.h"

namespace saw_ndt::internal {
namespace {

// Ground is taken to go on so far beside what is seen of it, and a vehicle may stand so near to it: it hides what is
// under it (columns).
constexpr int kGroundGoesOn = 40;
constexpr int kHiddenGround = 5;

// Without labels, a level surface so much higher than another one near by is no ground (m).
constexpr double kRoof_m = 2.0;
constexpr int kLowestBlock_m = 4;

// Larger voxels are taken to reach so many standard deviations from their mean.
constexpr double kReach_sigmas = 1.2;

int tileOf(int column) { return column >> 6; }
int placeInTile(const Column& column) { return (column.y & 63) * kPlaceTileSize + (column.x & 63); }

std::uint64_t keyOf(int x, int y) {
  return std::uint64_t{static_cast<std::uint32_t>(x)} << 32 | static_cast<std::uint32_t>(y);
}
std::uint64_t tileKey(const Column& column) { return keyOf(tileOf(column.x), tileOf(column.y)); }

// Visits the mean of a voxel, and the points around it that its distribution reaches where it is larger than a column.
template <typename Visit>
void visitPointsOf(const PackedNdtCell& cell, const Eigen::Vector3d& mean, double edge_m, const Visit& visit) {
  visit(mean);
  if (edge_m <= kColumn_m) return;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(inverseCovarianceOf(cell));
  const auto reach = [&](int k) -> Eigen::Vector3d {
    return kReach_sigmas / std::sqrt(std::max(solver.eigenvalues()[k], 1e-3)) * solver.eigenvectors().col(k);
  };
  const Eigen::Vector3d along = reach(0), across = reach(1);
  for (int i = -1; i <= 1; ++i) {
    for (int j = -1; j <= 1; ++j) {
      if (i != 0 || j != 0) visit(mean + i * along + j * across);
    }
  }
}

// Visits points that stand for what a target has: its ground, or all the rest.
template <typename Visit>
void visitPoints(const NdtTarget& target, bool ground, const Visit& visit) {
  for (const NdtLevel& level : target.levels()) {
    const std::vector<Eigen::Vector3d> means = level.means();
    for (std::size_t i = 0; i < means.size(); ++i) {
      const PackedNdtCell& cell = level.packedCells()[i];
      const bool is_ground = target.labelled() ? cell.ground_share > 0.5F : isLevel(cell);
      if (is_ground != ground) continue;
      if ((means[i].array().abs() < kFarthest_m).all()) visitPointsOf(cell, means[i], level.resolution(), visit);
    }
  }
}

}  // namespace

Column columnOf(const Eigen::Vector3d& point) {
  return {static_cast<int>(std::floor(point.x() / kColumn_m)), static_cast<int>(std::floor(point.y() / kColumn_m))};
}

std::optional<int> layerOf(double height_m) {
  const double layer = std::floor(height_m / kColumn_m);
  if (!(layer >= 0.0 && layer < kPlaceLayers)) return std::nullopt;
  return static_cast<int>(layer);
}

std::vector<Eigen::Vector3d> lowestOf(const std::vector<Eigen::Vector3d>& points, double most_height_m) {
  const auto blockOf = [](const Eigen::Vector3d& point, int axis) {
    return static_cast<int>(std::floor(point[axis] / kLowestBlock_m));
  };
  std::unordered_map<std::uint64_t, double> lowest;
  for (const Eigen::Vector3d& point : points) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        double& height =
            lowest.try_emplace(keyOf(blockOf(point, 0) + dx, blockOf(point, 1) + dy), point.z()).first->second;
        height = std::min(height, point.z());
      }
    }
  }
  std::vector<Eigen::Vector3d> ground;
  for (const Eigen::Vector3d& point : points) {
    if (point.z() < lowest.at(keyOf(blockOf(point, 0), blockOf(point, 1))) + most_height_m) ground.push_back(point);
  }
  return ground;
}

void GroundHeights::add(const Eigen::Vector3d& point) {
  const Column column = columnOf(point);
  Tile& tile = tiles_[tileKey(column)];
  const auto place = static_cast<std::size_t>(placeInTile(column));
  const bool is_first = std::exchange(tile.steps[place], std::uint8_t{0}) == kUnknown;
  const auto height_m = static_cast<float>(point.z());
  if (is_first || height_m < tile.height_m[place]) tile.height_m[place] = height_m;
}

void GroundHeights::spread(int steps) {
  std::vector<Column> border, next;
  for (const Column& at : tiles()) {
    const Tile& tile = tiles_.at(keyOf(at.x, at.y));
    const int x = at.x * kPlaceTileSize, y = at.y * kPlaceTileSize;
    for (int place = 0; place < kPlaceTileSize * kPlaceTileSize; ++place) {
      if (tile.steps[static_cast<std::size_t>(place)] == 0) {
        border.push_back({x + place % kPlaceTileSize, y + place / kPlaceTileSize});
      }
    }
  }
  // The same whatever the order of the tiles.
  std::sort(border.begin(), border.end(),
            [](const Column& a, const Column& b) { return std::pair(a.y, a.x) < std::pair(b.y, b.x); });
  constexpr Column kNeighbours[] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
  std::uint64_t latest_key = 0;
  Tile* latest = nullptr;  // neighbours are mostly in the same tile
  const auto tileOfColumn = [&](const Column& column) -> Tile& {
    const std::uint64_t key = tileKey(column);
    if (latest == nullptr || key != latest_key) latest = &tiles_[key];
    latest_key = key;
    return *latest;
  };
  for (int step = 1; step <= steps; ++step) {
    next.clear();
    for (const Column& column : border) {
      const float height_m = tileOfColumn(column).height_m[static_cast<std::size_t>(placeInTile(column))];
      for (const Column& way : kNeighbours) {
        const Column neighbour{column.x + way.x, column.y + way.y};
        Tile& tile = tileOfColumn(neighbour);
        const auto place = static_cast<std::size_t>(placeInTile(neighbour));
        if (tile.steps[place] != kUnknown) continue;
        tile.steps[place] = static_cast<std::uint8_t>(step);
        tile.height_m[place] = height_m;
        next.push_back(neighbour);
      }
    }
    border.swap(next);
  }
}

std::optional<float> GroundHeights::at(const Column& column) const {
  const auto tile = tiles_.find(tileKey(column));
  const auto place = static_cast<std::size_t>(placeInTile(column));
  if (tile == tiles_.end() || tile->second.steps[place] == kUnknown) return std::nullopt;
  return tile->second.height_m[place];
}

std::vector<Column> GroundHeights::tiles() const {
  std::vector<Column> tiles;
  for (const auto& [key, tile] : tiles_) {
    tiles.push_back({static_cast<std::int32_t>(key >> 32), static_cast<std::int32_t>(key & 0xFFFFFFFFU)});
  }
  return tiles;
}

std::uint8_t GroundHeights::stepsToSeen(const Column& column) const {
  const auto tile = tiles_.find(tileKey(column));
  return tile == tiles_.end() ? kUnknown : tile->second.steps[static_cast<std::size_t>(placeInTile(column))];
}

PlaceIndex::PlaceIndex(const NdtTarget& target) {
  GroundHeights ground;
  std::vector<Eigen::Vector3d> level;
  visitPoints(target, true, [&](const Eigen::Vector3d& point) {
    if (target.labelled()) {
      ground.add(point);
    } else {
      level.push_back(point);
    }
  });
  for (const Eigen::Vector3d& point : lowestOf(level, kRoof_m)) ground.add(point);
  for (const Column& tile : ground.tiles()) {
    tile_numbers_.emplace(keyOf(tile.x, tile.y), tiles_.size());
    tiles_.emplace_back().at = tile;
  }
  ground.spread(kGroundGoesOn);
  visitPoints(target, false, [&](const Eigen::Vector3d& point) {
    const Column column = columnOf(point);
    const std::optional<float> ground_m = ground.at(column);
    if (!ground_m) return;
    const std::optional<int> layer = layerOf(point.z() - *ground_m);
    if (!layer) return;
    const auto [found, is_new] = tile_numbers_.try_emplace(tileKey(column), tiles_.size());
    if (is_new) tiles_.emplace_back().at = {tileOf(column.x), tileOf(column.y)};
    const auto word = static_cast<std::size_t>(*layer * kPlaceTileRows + (column.y & 63));
    tiles_[found->second].words[word] |= std::uint64_t{1} << (column.x & 63);
  });
  for (Tile& tile : tiles_) {
    for (int place = 0; place < kPlaceTileSize * kPlaceTileSize; ++place) {
      const int row = place / kPlaceTileSize, x = place % kPlaceTileSize;
      const Column column{tile.at.x * kPlaceTileSize + x, tile.at.y * kPlaceTileSize + row};
      if (ground.stepsToSeen(column) > kHiddenGround) continue;
      tile.allowed[static_cast<std::size_t>(row)] |= std::uint64_t{1} << x;
      tile.ground_m[static_cast<std::size_t>(place)] = *ground.at(column);
    }
  }
  arrange();
}

PlaceIndex::PlaceIndex(std::vector<Tile> tiles) : tiles_(std::move(tiles)) { arrange(); }

bool PlaceIndex::Tile::hasStanding() const {
  return std::any_of(allowed.begin(), allowed.end(), [](std::uint64_t row) { return row != 0; });
}

// In an order that depends on where tiles are alone; with the first rows of the next tile repeated.
void PlaceIndex::arrange() {
  std::sort(tiles_.begin(), tiles_.end(),
            [](const Tile& a, const Tile& b) { return std::pair(a.at.y, a.at.x) < std::pair(b.at.y, b.at.x); });
  const auto others =
      std::stable_partition(tiles_.begin(), tiles_.end(), [](const Tile& tile) { return tile.hasStanding(); });
  standing_tile_count_ = static_cast<std::size_t>(others - tiles_.begin());
  tile_numbers_.clear();
  for (std::size_t i = 0; i < tiles_.size(); ++i) tile_numbers_.emplace(keyOf(tiles_[i].at.x, tiles_[i].at.y), i);
  for (Tile& tile : tiles_) {
    const auto next = tile_numbers_.find(keyOf(tile.at.x, tile.at.y + 1));
    if (next == tile_numbers_.end()) continue;
    const Tile& above = tiles_[next->second];
    for (int layer = 0; layer < kPlaceLayers; ++layer) {
      std::uint64_t* const words = tile.words.data() + layer * kPlaceTileRows;
      std::copy_n(above.words.data() + layer * kPlaceTileRows, kRowsAtOnce, words + kPlaceTileSize);
    }
  }
}

PlaceTables PlaceIndex::tablesAround(const Tile& tile) const {
  static const std::array<std::uint64_t, kPlaceTileWords> nothing{};
  PlaceTables tables{};
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const auto found = tile_numbers_.find(keyOf(tile.at.x + dx, tile.at.y + dy));
      tables.words[dy + 1][dx + 1] = (found == tile_numbers_.end() ? nothing : tiles_[found->second].words).data();
    }
  }
  return tables;
}

}  // namespace saw_ndt::internal
