#include "segmentation/ground_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "saw_ndt/common/geometry.h"

namespace saw_ndt::internal {
namespace {

constexpr int kColumns = 180;
// Rings of half a metre near the sensor, and then by so much wider than the one before.
constexpr float kLeastRingWidth_m = 0.5F;
constexpr float kRingGrowth = 1.05F;
constexpr float kFarthest_m = 200.0F;
// Which share of the points of a cell may be below its ground: mirrored and mixed returns.
constexpr std::size_t kPointsPerOutlier = 20;

/// Outer borders of the rings, nearest first.
const std::vector<float>& ringBorders() {
  static const std::vector<float> borders = [] {
    std::vector<float> result;
    float width = kLeastRingWidth_m;
    for (float border = width; border < kFarthest_m; border += width) {
      result.push_back(border);
      if (border > kLeastRingWidth_m / (kRingGrowth - 1.0F)) width *= kRingGrowth;
    }
    return result;
  }();
  return borders;
}

int columnOf(float x, float y) {
  const float turns = std::atan2(y, x) / static_cast<float>(2.0 * kPi);
  const auto column = static_cast<int>((turns < 0.0F ? turns + 1.0F : turns) * kColumns);
  return std::min(column, kColumns - 1);
}

}  // namespace

void GroundGrid::project(const ScanView& scan, const ScanProjection& projection) {
  const std::vector<float>& borders = ringBorders();
  rows_ = static_cast<int>(borders.size());
  columns_ = kColumns;
  const std::size_t cells = static_cast<std::size_t>(rows_) * kColumns;
  cell_of_point_.assign(scan.size, kNoCell);
  height_of_point_.resize(scan.size);
  horizontal_range_of_point_.resize(scan.size);
  first_of_cell_.assign(cells + 1, 0);
  for (std::size_t i = 0; i < scan.size; ++i) {
    const Eigen::Map<const Eigen::Vector3f> point(scan.point(i));
    const float range = point.norm();
    if (!(range > projection.min_range_m && range <= projection.max_range_m)) continue;
    if (!projection.vehicle.isEmpty() && projection.vehicle.contains(point)) continue;
    const Eigen::Vector3f level = projection.R_level_lidar * point;
    const float horizontal_range = std::hypot(level.x(), level.y());
    const auto ring = std::upper_bound(borders.begin(), borders.end(), horizontal_range) - borders.begin();
    if (ring == rows_) continue;
    const auto cell = static_cast<std::int32_t>((rows_ - 1 - ring) * kColumns + columnOf(level.x(), level.y()));
    cell_of_point_[i] = cell;
    height_of_point_[i] = level.z();
    horizontal_range_of_point_[i] = horizontal_range;
    ++first_of_cell_[static_cast<std::size_t>(cell)];
  }
  // Counts become the ends of the cells, and, as points are placed from the last one on, their beginnings.
  std::int32_t end = 0;
  for (std::int32_t& count : first_of_cell_) count = end += count;
  points_.resize(static_cast<std::size_t>(end));
  for (std::size_t i = scan.size; i-- > 0;) {
    if (cell_of_point_[i] == kNoCell) continue;
    const std::int32_t place = --first_of_cell_[static_cast<std::size_t>(cell_of_point_[i])];
    points_[static_cast<std::size_t>(place)] = {static_cast<std::uint32_t>(i), horizontal_range_of_point_[i],
                                                height_of_point_[i]};
  }
  range_.assign(cells, 0.0F);
  horizontal_range_.assign(cells, 0.0F);
  height_.assign(cells, 0.0F);
  for (std::int32_t cell = 0; cell < static_cast<std::int32_t>(cells); ++cell) placeLowest(cell);
}

void GroundGrid::placeLowest(std::int32_t cell) {
  const auto place = static_cast<std::size_t>(cell);
  const auto begin = points_.begin() + first_of_cell_[place];
  const auto end = points_.begin() + first_of_cell_[place + 1];
  if (begin == end) return;
  const auto lowest = begin + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(end - begin) / kPointsPerOutlier);
  std::nth_element(begin, lowest, end, [](const LevelPoint& a, const LevelPoint& b) { return a.height < b.height; });
  range_[place] = std::hypot(lowest->horizontal_range, lowest->height);
  horizontal_range_[place] = lowest->horizontal_range;
  height_[place] = lowest->height;
}

void GroundGrid::labelGround(const std::vector<std::uint8_t>& ground, const GroundOptions& options) {
  // What the lowest points of a cell lie below the others by noise, roughness and the slope across the cell.
  const auto slope = static_cast<float>(std::tan(radiansFromDegrees(options.slope_deg)));
  const auto tolerance = static_cast<float>(options.step_tolerance_m + options.profile_tolerance_m);
  obstacles_of_cell_.assign(ground.size(), 0);
  for (std::size_t cell = 0; cell < ground.size(); ++cell) {
    for (std::int32_t i = first_of_cell_[cell]; i < first_of_cell_[cell + 1]; ++i) {
      const LevelPoint& point = points_[static_cast<std::size_t>(i)];
      StructuralLabel& label = point_labels_[static_cast<std::size_t>(i)];
      label = StructuralLabel::NON_GROUND;
      if (ground[cell] != 0) {
        const float above = point.height - height_[cell];
        const float reach = tolerance + slope * std::abs(point.horizontal_range - horizontal_range_[cell]);
        if (above < -reach) {
          label = StructuralLabel::NOISE;
        } else if (above <= reach) {
          label = StructuralLabel::GROUND;
        }
      }
      if (label == StructuralLabel::NON_GROUND) ++obstacles_of_cell_[cell];
    }
  }
}

// Components of cells that hold obstacles and touch, be it at a corner.
void GroundGrid::growComponents() {
  constexpr std::int32_t kUnknown = -1;
  component_of_cell_.assign(obstacles_of_cell_.size(), kUnknown);
  components_.clear();
  for (std::int32_t seed = 0; seed < static_cast<std::int32_t>(obstacles_of_cell_.size()); ++seed) {
    if (obstacles_of_cell_[static_cast<std::size_t>(seed)] == 0) continue;
    if (component_of_cell_[static_cast<std::size_t>(seed)] != kUnknown) continue;
    const auto number = static_cast<std::int32_t>(components_.size());
    Component& component = components_.emplace_back();
    component.lowest = std::numeric_limits<float>::max();
    component.highest = -component.lowest;
    component_of_cell_[static_cast<std::size_t>(seed)] = number;
    waiting_.assign(1, seed);
    while (!waiting_.empty()) {
      const std::int32_t cell = waiting_.back();
      waiting_.pop_back();
      component.points += obstacles_of_cell_[static_cast<std::size_t>(cell)];
      for (std::int32_t i = first_of_cell_[static_cast<std::size_t>(cell)];
           i < first_of_cell_[static_cast<std::size_t>(cell) + 1]; ++i) {
        if (point_labels_[static_cast<std::size_t>(i)] != StructuralLabel::NON_GROUND) continue;
        component.lowest = std::min(component.lowest, points_[static_cast<std::size_t>(i)].height);
        component.highest = std::max(component.highest, points_[static_cast<std::size_t>(i)].height);
      }
      const std::int32_t row = cell / kColumns, column = cell % kColumns;
      for (std::int32_t r = std::max(0, row - 1); r <= std::min(rows_ - 1, row + 1); ++r) {
        for (const std::int32_t turn : {kColumns - 1, 0, 1}) {
          const auto neighbour = static_cast<std::size_t>(r * kColumns + (column + turn) % kColumns);
          if (obstacles_of_cell_[neighbour] == 0 || component_of_cell_[neighbour] != kUnknown) continue;
          component_of_cell_[neighbour] = number;
          waiting_.push_back(static_cast<std::int32_t>(neighbour));
        }
      }
    }
  }
}

void GroundGrid::label(const std::vector<std::uint8_t>& ground, const SegmentationOptions& options,
                       std::vector<StructuralLabel>& labels) {
  // As much as three beams of a common LiDAR span at 10 m.
  constexpr float kTall_m = 0.3F;
  point_labels_.resize(points_.size());
  labelGround(ground, options.ground);
  growComponents();
  labels.assign(cell_of_point_.size(), StructuralLabel::NOISE);
  for (std::size_t cell = 0; cell < ground.size(); ++cell) {
    bool keeps = false;
    if (obstacles_of_cell_[cell] > 0) {
      const Component& component = components_[static_cast<std::size_t>(component_of_cell_[cell])];
      keeps =
          component.points >= options.components.min_points ||
          (component.points >= options.components.min_points_tall && component.highest - component.lowest >= kTall_m);
    }
    for (std::int32_t i = first_of_cell_[cell]; i < first_of_cell_[cell + 1]; ++i) {
      const StructuralLabel label = point_labels_[static_cast<std::size_t>(i)];
      if (label == StructuralLabel::NON_GROUND && !keeps) continue;
      labels[points_[static_cast<std::size_t>(i)].index] = label;
    }
  }
}

}  // namespace saw_ndt::internal
