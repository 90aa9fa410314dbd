#include "localization/scan_outline.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <unordered_map>

#include "localization/place_index.h"

namespace saw_ndt::internal {
namespace {

constexpr double kRange_m = 60.0;

// What stands below this layer may have been driven away; it counts where less stands above.
constexpr int kLowestLastingLayer = 2;
constexpr std::size_t kEnoughCells = 100;

// Without labels, points so near to the lowest are ground (m).
constexpr double kGroundThickness_m = 0.5;

constexpr int kGroundGoesOn = 60;

struct CellSums {
  float x = 0.0F, y = 0.0F;
  int count = 0;
  int layer = 0;
};

struct LabelledPoints {
  std::vector<Eigen::Vector3d> ground, other;
};

LabelledPoints pointsOf(const SourcePoints& source) {
  LabelledPoints points;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const Eigen::Vector3d point(source.x[i], source.y[i], source.z[i]);
    if (!(std::max(std::abs(point.x()), std::abs(point.y())) < kRange_m)) continue;
    const auto label = static_cast<StructuralLabel>(source.label[i]);
    if (label == StructuralLabel::GROUND) points.ground.push_back(point);
    if (label == StructuralLabel::NON_GROUND) points.other.push_back(point);
  }
  if (!source.labelled) points.ground = lowestOf(points.other, kGroundThickness_m);
  return points;
}

// An order that looks random, so that every part of a scan keeps its share.
std::uint64_t scattered(std::uint64_t key) {
  key = (key ^ (key >> 31)) * 0x7FB5D329728EA185U;
  key = (key ^ (key >> 27)) * 0x81DADEF4BC2DD44DU;
  return key ^ (key >> 33);
}

}  // namespace

ScanOutline outlineOf(const SourcePoints& source, std::size_t most_cells) {
  const LabelledPoints points = pointsOf(source);
  GroundHeights ground;
  for (const Eigen::Vector3d& point : points.ground) ground.add(point);
  ground.spread(kGroundGoesOn);
  ScanOutline outline;
  outline.base_height_m = -static_cast<double>(ground.at({0, 0}).value_or(0.0F));

  std::unordered_map<std::uint64_t, CellSums> cells;
  for (const Eigen::Vector3d& point : points.other) {
    const Column column = columnOf(point);
    const std::optional<float> ground_m = ground.at(column);
    if (!ground_m || point.squaredNorm() > kRange_m * kRange_m) continue;
    const double height_m = point.z() - *ground_m;
    const std::optional<int> layer = layerOf(height_m);
    if (!layer || (!source.labelled && height_m < kGroundThickness_m)) continue;
    const std::uint64_t key = static_cast<std::uint64_t>(column.x + kPlaceTileSize) << 32 |
                              static_cast<std::uint64_t>(column.y + kPlaceTileSize) << 16 |
                              static_cast<std::uint64_t>(*layer);
    CellSums& cell = cells[scattered(key)];
    cell.x += static_cast<float>(point.x());
    cell.y += static_cast<float>(point.y());
    ++cell.count;
    cell.layer = *layer;
  }

  std::vector<std::pair<std::uint64_t, CellSums>> lasting, low;
  for (const auto& cell : cells) (cell.second.layer >= kLowestLastingLayer ? lasting : low).push_back(cell);
  const auto scatter = [](auto& some) {
    std::sort(some.begin(), some.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  };
  scatter(lasting);
  scatter(low);
  if (lasting.size() < kEnoughCells) {
    lasting.insert(lasting.end(), low.begin(),
                   low.begin() + static_cast<std::ptrdiff_t>(std::min(low.size(), kEnoughCells - lasting.size())));
  }
  for (std::size_t i = 0; i < std::min(lasting.size(), most_cells); ++i) {
    const CellSums& cell = lasting[i].second;
    const auto count = static_cast<float>(cell.count);
    outline.cells.push_back({cell.x / count, cell.y / count, cell.layer});
  }
  return outline;
}

}  // namespace saw_ndt::internal
