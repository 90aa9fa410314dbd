#include "map/localization_tile.h"

#include <algorithm>
#include <boost/endian/conversion.hpp>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "map/voxel_index.h"

namespace saw_ndt::internal {
namespace {

// The first voxel along an axis whose centre lies in a tile.
int firstVoxelOf(int tile, double resolution_m) {
  return static_cast<int>(std::ceil(tile * kLocalizationTile_m / resolution_m - 0.5));
}

int tileAlong(int voxel, double resolution_m) {
  int tile = static_cast<int>(std::floor((voxel + 0.5) * resolution_m / kLocalizationTile_m));
  // Where rounding has the centre on the other side of an edge than firstVoxelOf().
  if (voxel < firstVoxelOf(tile, resolution_m)) --tile;
  if (voxel >= firstVoxelOf(tile + 1, resolution_m)) ++tile;
  return tile;
}

struct LevelHead {
  std::uint32_t cell_count = 0;
  std::int32_t least_z = 0;
};
static_assert(sizeof(LevelHead) == 8);

LevelHead inFileOrder(LevelHead head) {
  boost::endian::native_to_little_inplace(head.cell_count);
  boost::endian::native_to_little_inplace(head.least_z);
  return head;
}

// To or from the byte order of files.
void reorder(QuantizedCell& cell) {
  if (boost::endian::order::native == boost::endian::order::little) return;
  const auto reverse = [](auto& value) { boost::endian::endian_reverse_inplace(value); };
  for (auto& place : cell.place) reverse(place);
  for (auto& mean : cell.mean) reverse(mean);
  for (auto& element : cell.root) reverse(element);
  std::uint32_t bits = 0;
  std::memcpy(&bits, &cell.greatest_root, sizeof bits);
  reverse(bits);
  std::memcpy(&cell.greatest_root, &bits, sizeof bits);
  reverse(cell.mean_confidence);
}

// By bricks of a VoxelIndex, those and the voxels of each by z, y and x.
std::vector<std::size_t> inBrickOrder(const std::vector<VoxelCoordinate>& voxels) {
  std::vector<std::size_t> order(voxels.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    for (const int shift : {VoxelIndex::kBrickBits, 0}) {
      for (const int axis : {2, 1, 0}) {
        const int at_a = voxels[a][axis] >> shift, at_b = voxels[b][axis] >> shift;
        if (at_a != at_b) return at_a < at_b;
      }
    }
    return false;
  });
  return order;
}

// Calls visit(level, voxel, cell) for the cells of a tile; false where the bytes are no such tile.
template <typename Visit>
bool visitCells(const char* bytes, std::size_t size, const TileCoordinate& at, const std::vector<double>& resolutions_m,
                const Visit& visit) {
  const std::size_t level_count = resolutions_m.size();
  if (size < level_count * sizeof(LevelHead)) return false;
  std::vector<LevelHead> heads(level_count);
  std::memcpy(heads.data(), bytes, level_count * sizeof(LevelHead));
  std::size_t cell_count = 0;
  for (LevelHead& head : heads) {
    head = inFileOrder(head);
    cell_count += head.cell_count;
  }
  const char* next = bytes + level_count * sizeof(LevelHead);
  if (size - level_count * sizeof(LevelHead) != cell_count * sizeof(QuantizedCell)) return false;
  constexpr int kHighest = std::numeric_limits<std::int32_t>::max() - std::numeric_limits<std::uint16_t>::max();
  for (std::size_t level = 0; level < level_count; ++level) {
    const LevelHead& head = heads[level];
    const int x = firstVoxelOf(at.x, resolutions_m[level]), y = firstVoxelOf(at.y, resolutions_m[level]);
    const int x_count = firstVoxelOf(at.x + 1, resolutions_m[level]) - x;
    const int y_count = firstVoxelOf(at.y + 1, resolutions_m[level]) - y;
    if (head.least_z > kHighest) return false;
    for (std::uint32_t i = 0; i < head.cell_count; ++i, next += sizeof(QuantizedCell)) {
      QuantizedCell cell;
      std::memcpy(&cell, next, sizeof cell);
      reorder(cell);
      if (!isValid(cell) || cell.place[0] >= x_count || cell.place[1] >= y_count) return false;
      visit(level, VoxelCoordinate(x + cell.place[0], y + cell.place[1], head.least_z + cell.place[2]), cell);
    }
  }
  return true;
}

}  // namespace

bool isWithinReach(const TileCoordinate& tile, double resolution_m) {
  constexpr double kFarthestVoxel = 2.0e9;
  const double farthest_m =
      (std::max(std::abs(double{1} * tile.x), std::abs(double{1} * tile.y)) + 1.0) * kLocalizationTile_m;
  return farthest_m <= std::min(kFarthestTile_m, kFarthestVoxel * resolution_m);
}

TileCoordinate localizationTileOf(const VoxelCoordinate& voxel, double resolution_m) {
  return {tileAlong(voxel.x(), resolution_m), tileAlong(voxel.y(), resolution_m)};
}

TileCoordinate localizationTileAt(double x_m, double y_m) {
  return {static_cast<int>(std::floor(x_m / kLocalizationTile_m)),
          static_cast<int>(std::floor(y_m / kLocalizationTile_m))};
}

void LocalizationTile::add(std::size_t level, const VoxelStatistics& statistics, double resolution_m) {
  levels[level].voxels.push_back(statistics.voxel);
  levels[level].cells.push_back(quantized(statistics, resolution_m));
}

std::size_t LocalizationTile::cellCount() const {
  std::size_t count = 0;
  for (const TileLevel& level : levels) count += level.cells.size();
  return count;
}

std::string encodedTile(const LocalizationTile& tile, const std::vector<double>& resolutions_m) {
  std::string bytes, cells;
  for (std::size_t k = 0; k < tile.levels.size(); ++k) {
    const TileLevel& level = tile.levels[k];
    const int x = firstVoxelOf(tile.at.x, resolutions_m[k]), y = firstVoxelOf(tile.at.y, resolutions_m[k]);
    const std::vector<std::size_t> order = inBrickOrder(level.voxels);
    int least_z = order.empty() ? 0 : level.voxels.front().z();
    for (const VoxelCoordinate& voxel : level.voxels) least_z = std::min(least_z, voxel.z());
    const LevelHead head = inFileOrder({static_cast<std::uint32_t>(level.cells.size()), least_z});
    bytes.append(reinterpret_cast<const char*>(&head), sizeof head);
    for (const std::size_t i : order) {
      const VoxelCoordinate& voxel = level.voxels[i];
      const std::int64_t z = std::int64_t{voxel.z()} - least_z;
      if (z > std::numeric_limits<std::uint16_t>::max()) {
        throw std::length_error("the voxels of a tile lie " + std::to_string(z) +
                                " voxels above each other: a localization map has room for 65535");
      }
      QuantizedCell cell = level.cells[i];
      cell.place[0] = static_cast<std::uint16_t>(voxel.x() - x);
      cell.place[1] = static_cast<std::uint16_t>(voxel.y() - y);
      cell.place[2] = static_cast<std::uint16_t>(z);
      reorder(cell);
      cells.append(reinterpret_cast<const char*>(&cell), sizeof cell);
    }
  }
  return bytes + cells;
}

bool appendDecodedTile(const char* bytes, std::size_t size, const TileCoordinate& at,
                       const std::vector<double>& resolutions_m, const VoxelWeighting& weighting,
                       const LocalizationClip& clip, std::vector<NdtCells>& cells) {
  const double squared_radius = clip.radius_m * clip.radius_m;
  return visitCells(bytes, size, at, resolutions_m,
                    [&](std::size_t level, const VoxelCoordinate& voxel, const QuantizedCell& cell) {
                      const double resolution_m = resolutions_m[level];
                      const Eigen::Vector2d middle_m = (voxel.head<2>().cast<double>().array() + 0.5) * resolution_m;
                      if ((middle_m - clip.centre_m).squaredNorm() > squared_radius) return;
                      cells[level].voxels.push_back(voxel);
                      cells[level].packed.push_back(dequantized(cell, resolution_m, weighting));
                    });
}

bool forEachCell(const char* bytes, std::size_t size, const TileCoordinate& at,
                 const std::vector<double>& resolutions_m,
                 const std::function<void(std::size_t level, const QuantizedCell& cell)>& visit) {
  return visitCells(bytes, size, at, resolutions_m,
                    [&](std::size_t level, const VoxelCoordinate&, const QuantizedCell& cell) { visit(level, cell); });
}

}  // namespace saw_ndt::internal
