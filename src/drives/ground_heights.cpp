#include "drives/ground_heights.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

namespace saw_ndt::internal {

namespace {

constexpr double kFarthest_m = 1e8;
constexpr int kLeastPoints = 3;              // of a layer
constexpr double kLeastShare = 0.02;         // of a column's points, for a layer to be no outlier
constexpr int kLayerBins = 3;                // how thick a layer is
constexpr int kEnvelopeRadius = 5;           // cells around that a layer is compared with
constexpr double kSteepest = 0.3;            // metres a metre
constexpr double kAboveEnvelope_m = 0.2;     // so much a layer of ground may stand above
constexpr std::size_t kEnvelopeRank = 2;     // two cells around may lie too low
constexpr int kPlaneRadius = 3;              // cells around that a plane is fitted to
constexpr std::size_t kLeastPlaneCells = 6;  // for a plane that is inclined
constexpr double kPlaneOutlier_m = 0.15;
constexpr double kLowestGround_m = -0.3, kHighestGround_m = 0.2;

struct CellPlace {
  std::int32_t x, y;
};

GroundCell cellAt(CellPlace place) {
  return static_cast<std::uint64_t>(static_cast<std::uint32_t>(place.x)) << 32U | static_cast<std::uint32_t>(place.y);
}

CellPlace placeOf(GroundCell cell) {
  return {static_cast<std::int32_t>(static_cast<std::uint32_t>(cell >> 32U)),
          static_cast<std::int32_t>(static_cast<std::uint32_t>(cell))};
}

bool isNear(const float* xyz) {
  return std::abs(xyz[0]) < kFarthest_m && std::abs(xyz[1]) < kFarthest_m && std::abs(xyz[2]) < kFarthest_m;
}

CellPlace placeOf(const float* xyz) {
  return {static_cast<std::int32_t>(std::floor(xyz[0] / kGroundCell_m)),
          static_cast<std::int32_t>(std::floor(xyz[1] / kGroundCell_m))};
}

using Layers = std::unordered_map<GroundCell, double>;

/// Calls take(dx, dy, height) for each layer that is so many cells away at most, in x and in y.
template <typename Take>
void forEachAround(const Layers& layers, CellPlace middle, int radius, const Take& take) {
  for (int dx = -radius; dx <= radius; ++dx) {
    for (int dy = -radius; dy <= radius; ++dy) {
      const auto found = layers.find(cellAt({middle.x + dx, middle.y + dy}));
      if (found != layers.end()) take(dx, dy, found->second);
    }
  }
}

/// The layers that do not stand above those around.
Layers groundOf(const Layers& layers) {
  Layers ground;
  std::vector<double> bounds;
  for (const auto& [cell, height_m] : layers) {
    bounds.clear();
    forEachAround(layers, placeOf(cell), kEnvelopeRadius, [&bounds](int dx, int dy, double around_m) {
      const double distance_m = kGroundCell_m * std::hypot(dx, dy);
      bounds.push_back(around_m + kSteepest * std::max(0.0, distance_m - kGroundCell_m));
    });
    if (bounds.size() <= kEnvelopeRank) continue;
    const auto bound = bounds.begin() + static_cast<std::ptrdiff_t>(kEnvelopeRank);
    std::nth_element(bounds.begin(), bound, bounds.end());
    if (height_m <= *bound + kAboveEnvelope_m) ground.emplace(cell, height_m);
  }
  return ground;
}

struct Sample {
  Eigen::Vector3d base;  // 1, x, y from the middle of the cell (m)
  double height_m;
};

/// The plane of samples, by least squares; level where they are few.
GroundSurface::Plane fitted(const std::vector<Sample>& samples) {
  Eigen::Matrix3d normal = Eigen::Vector3d(0.0, 0.1, 0.1).asDiagonal();  // level where nothing speaks for a slope
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const Sample& sample : samples) {
    normal += sample.base * sample.base.transpose();
    right += sample.base * sample.height_m;
  }
  if (samples.size() < kLeastPlaneCells) return {right[0] / static_cast<double>(samples.size()), 0.0, 0.0};
  const Eigen::Vector3d plane = normal.inverse() * right;
  return {plane[0], plane[1], plane[2]};
}

GroundSurface::Plane planeOf(std::vector<Sample>& samples) {
  // About their mean, so that "level" above means what it says.
  double mean_m = 0.0;
  for (const Sample& sample : samples) mean_m += sample.height_m / static_cast<double>(samples.size());
  for (Sample& sample : samples) sample.height_m -= mean_m;
  GroundSurface::Plane plane = fitted(samples);
  const auto is_outlier = [&plane](const Sample& sample) {
    const double height_m = plane.height_m + plane.slope_x * sample.base[1] + plane.slope_y * sample.base[2];
    return std::abs(sample.height_m - height_m) > kPlaneOutlier_m;
  };
  const auto end = std::remove_if(samples.begin(), samples.end(), is_outlier);
  if (end != samples.begin() && end != samples.end()) {
    samples.erase(end, samples.end());
    plane = fitted(samples);
  }
  plane.height_m += mean_m;
  return plane;
}

}  // namespace

bool GroundSurface::isGround(const float* xyz) const {
  if (!isNear(xyz)) return false;
  const CellPlace place = placeOf(xyz);
  const auto found = planes_.find(cellAt(place));
  if (found == planes_.end()) return false;
  const Plane& plane = found->second;
  const double x_m = xyz[0] - (place.x + 0.5) * kGroundCell_m, y_m = xyz[1] - (place.y + 0.5) * kGroundCell_m;
  const double above_m = xyz[2] - (plane.height_m + plane.slope_x * x_m + plane.slope_y * y_m);
  return above_m >= kLowestGround_m && above_m <= kHighestGround_m;
}

void LowestHeights::add(const float* xyz) {
  if (!isNear(xyz)) return;
  const auto bin = static_cast<std::int32_t>(std::floor(xyz[2] / kBin_m));
  const auto [found, is_new] = columns_.try_emplace(cellAt(placeOf(xyz)));
  Column& column = found->second;
  if (is_new) column.lowest_bin = bin;
  if (bin < column.lowest_bin) {
    // What this takes out of reach above is out of reach for good, whatever comes in which order.
    const int shift = std::min(column.lowest_bin - bin, kBins);
    std::move_backward(column.counts.begin(), column.counts.end() - shift, column.counts.end());
    std::fill_n(column.counts.begin(), shift, std::uint8_t{0});
    column.lowest_bin = bin;
  }
  const int index = bin - column.lowest_bin;
  if (index >= kBins) return;
  std::uint8_t& count = column.counts[static_cast<std::size_t>(index)];
  if (count < 255) ++count;
}

bool LowestHeights::lowestLayer(const Column& column, double& height_m) {
  int total = 0;
  for (const std::uint8_t count : column.counts) total += count;
  const double least = std::max<double>(kLeastPoints, kLeastShare * total);
  for (std::size_t first = 0; first < kBins; ++first) {
    if (column.counts[first] == 0) continue;
    int points = 0;
    double sum = 0.0;
    for (std::size_t bin = first; bin < std::min<std::size_t>(first + kLayerBins, kBins); ++bin) {
      points += column.counts[bin];
      sum += column.counts[bin] * (static_cast<double>(bin) + 0.5);
    }
    if (points < least) continue;
    height_m = (column.lowest_bin + sum / points) * kBin_m;
    return true;
  }
  return false;
}

GroundSurface LowestHeights::surface() const {
  Layers layers;
  for (const auto& [cell, column] : columns_) {
    double height_m = 0.0;
    if (lowestLayer(column, height_m)) layers.emplace(cell, height_m);
  }
  const Layers ground = groundOf(layers);
  std::unordered_map<GroundCell, GroundSurface::Plane> planes;
  std::vector<Sample> samples;
  for (const auto& [cell, column] : columns_) {
    samples.clear();
    forEachAround(ground, placeOf(cell), kPlaneRadius, [&samples](int dx, int dy, double height_m) {
      samples.push_back({Eigen::Vector3d(1.0, dx * kGroundCell_m, dy * kGroundCell_m), height_m});
    });
    if (!samples.empty()) planes.emplace(cell, planeOf(samples));
  }
  return GroundSurface(std::move(planes));
}

}  // namespace saw_ndt::internal
