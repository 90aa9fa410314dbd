#include "map/seen_places.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "common/floor_division.h"

namespace saw_ndt::internal {
namespace {

// Light that met a surface came from a LiDAR on a vehicle, this high at least as far as can be told.
constexpr double kSureHeight_m = 2.0;
constexpr double kAreaEdge_m = 4.0;
constexpr int kAreasAround = 2;  // 8 m at least

int voxelsIn(double length_m, double resolution_m) {
  return std::max(1, static_cast<int>(std::min(1e6, std::round(length_m / resolution_m))));
}

}  // namespace

SeenPlaces::SeenPlaces(const MapSurfaces& surfaces)
    : sure_height_(voxelsIn(kSureHeight_m, surfaces.resolution())),
      area_edge_(voxelsIn(kAreaEdge_m, surfaces.resolution())) {
  const std::vector<Surface>& all = surfaces.all();
  std::vector<std::uint32_t> order(all.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto key = [&all](std::uint32_t i) {
    const VoxelCoordinate& voxel = all[i].voxel;
    return std::make_tuple(voxel.y(), voxel.x(), voxel.z());
  };
  std::sort(order.begin(), order.end(), [&key](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });

  std::vector<VoxelCoordinate> columns, areas;
  for (const std::uint32_t i : order) {
    const VoxelCoordinate& voxel = all[i].voxel;
    const VoxelCoordinate column(voxel.x(), voxel.y(), 0);
    if (columns.empty() || columns.back() != column) {
      columns.push_back(column);
      columns_.push_back({heights_.size(), heights_.size(), 0});
    }
    const std::uint64_t before = columns_.back().first == columns_.back().last ? 0 : points_.back();
    heights_.push_back(voxel.z());
    points_.push_back(before + all[i].point_count);
    columns_.back().last = heights_.size();
    columns_.back().most_scans = std::max(columns_.back().most_scans, all[i].scan_count);
  }
  column_index_ = VoxelIndex(columns);

  std::vector<std::pair<VoxelCoordinate, int>> tops;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    tops.emplace_back(areaOf(columns[c]), heights_[columns_[c].last - 1]);
  }
  const auto by_area_and_height = [](const auto& a, const auto& b) {
    return std::make_tuple(a.first.y(), a.first.x(), b.second) < std::make_tuple(b.first.y(), b.first.x(), a.second);
  };
  std::sort(tops.begin(), tops.end(), by_area_and_height);
  for (const auto& [area, height] : tops) {
    if (!areas.empty() && areas.back() == area) continue;
    areas.push_back(area);
    greatest_heights_.push_back(height);
  }
  area_index_ = VoxelIndex(areas);
}

VoxelCoordinate SeenPlaces::areaOf(const VoxelCoordinate& voxel) const {
  return {floorDivided(voxel.x(), area_edge_), floorDivided(voxel.y(), area_edge_), 0};
}

const SeenPlaces::Column* SeenPlaces::columnAt(int x, int y) const {
  const std::int32_t number = column_index_.find({x, y, 0});
  return number == VoxelIndex::kNone ? nullptr : &columns_[static_cast<std::size_t>(number)];
}

// Those of the column and of the eight around it.
std::uint64_t SeenPlaces::pointsUpTo(const VoxelCoordinate& voxel) const {
  std::uint64_t sum = 0;
  for (int i = 0; i < 9; ++i) {
    const Column* const column = columnAt(voxel.x() + i % 3 - 1, voxel.y() + i / 3 - 1);
    if (column == nullptr) continue;
    const auto first = heights_.begin() + static_cast<std::ptrdiff_t>(column->first);
    const auto above = std::upper_bound(first, heights_.begin() + static_cast<std::ptrdiff_t>(column->last), voxel.z());
    if (above != first) sum += points_[static_cast<std::size_t>(above - heights_.begin()) - 1];
  }
  return sum;
}

bool SeenPlaces::reaches(const VoxelCoordinate& voxel) const {
  const VoxelCoordinate area = areaOf(voxel);
  for (int y = -kAreasAround; y <= kAreasAround; ++y) {
    for (int x = -kAreasAround; x <= kAreasAround; ++x) {
      const std::int32_t number = area_index_.find(area + VoxelCoordinate(x, y, 0));
      if (number != VoxelIndex::kNone && greatest_heights_[static_cast<std::size_t>(number)] >= voxel.z()) return true;
    }
  }
  return false;
}

std::uint32_t SeenPlaces::mostScansAround(const VoxelCoordinate& voxel) const {
  std::uint32_t most = 0;
  for (int i = 0; i < 9; ++i) {
    const Column* const column = columnAt(voxel.x() + i % 3 - 1, voxel.y() + i / 3 - 1);
    if (column != nullptr) most = std::max(most, column->most_scans);
  }
  return most;
}

bool SeenPlaces::cover(const VoxelCoordinate& voxel, std::uint64_t point_count, const SeenPlaces& other,
                       std::uint64_t least_points) const {
  const Column* const column = columnAt(voxel.x(), voxel.y());
  if (column == nullptr || heights_[column->first] > voxel.z()) return false;
  const auto above = std::upper_bound(heights_.begin() + static_cast<std::ptrdiff_t>(column->first),
                                      heights_.begin() + static_cast<std::ptrdiff_t>(column->last), voxel.z());
  if (voxel.z() - *(above - 1) > sure_height_ && !reaches(voxel)) return false;
  const double share =
      static_cast<double>(pointsUpTo(voxel)) / static_cast<double>(std::max(other.pointsUpTo(voxel), std::uint64_t{1}));
  return static_cast<double>(point_count) * std::min(1.0, share) >= static_cast<double>(least_points);
}

}  // namespace saw_ndt::internal
