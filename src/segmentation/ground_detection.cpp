#include "segmentation/ground_detection.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"
#include "segmentation/ground_loops.h"

namespace saw_ndt::internal {
namespace {

float tangent(double degrees) { return static_cast<float>(std::tan(radiansFromDegrees(degrees))); }

}  // namespace

void GroundDetection::detect(const PixelImage& image, const SensorModel& sensor, const GroundOptions& options,
                             std::vector<std::uint8_t>& ground, const std::vector<float>& lowest_tangents) {
  if (options.rule == GroundRule::INCLINATION) {
    detectByInclination(image, sensor, options, ground);
    return;
  }
  const auto columns = static_cast<std::size_t>(image.columns());
  sensor_height_ = estimatedSensorHeight(image, options);
  last_range_.assign(columns, 0.0F);
  if (!lowest_tangents.empty()) beginWhereBeamsMeetGround(lowest_tangents);
  last_height_.assign(columns, -sensor_height_);
  profile_height_.assign(columns, -sensor_height_);
  states_.resize(image.range().size());
  no_returns_.assign(columns, 0);
  neighbour_sums_.returns.resize(columns + 2);
  neighbour_sums_.ground.resize(columns + 2);
  ground.resize(image.range().size());
  grow(image, options, 0, columns);
  if (options.foot_angle_deg < 90.0) doubtFeet(image, sensor, options);
  for (int row = 0; row < image.rows(); ++row) settle(image, row, options.smooths, neighbour_sums_, ground);
}

void GroundDetection::detectByInclination(const PixelImage& image, const SensorModel& sensor,
                                          const GroundOptions& options, std::vector<std::uint8_t>& ground) {
  ground.assign(image.range().size(), 0);
  const float limit = tangent(options.inclination_limit_deg);
  const int columns = image.columns();
  for (int row = image.rows() - 1; row > 0; --row) {
    if (sensor.elevations_deg[row - 1] > options.inclination_top_elevation_deg) break;
    for (int column = 0; column < columns; ++column) {
      const int lower = row * columns + column;
      const int upper = lower - columns;
      if (image.range()[lower] <= 0.0F || image.range()[upper] <= 0.0F) continue;
      const float rise = std::abs(image.height()[upper] - image.height()[lower]);
      const float run = std::abs(image.horizontalRange()[upper] - image.horizontalRange()[lower]);
      if (rise <= limit * run) ground[lower] = ground[upper] = 1;
    }
  }
}

float GroundDetection::estimatedSensorHeight(const PixelImage& image, const GroundOptions& options) {
  if (options.sensor_height_m > 0.0) return static_cast<float>(options.sensor_height_m);
  // The lowest level pair of returns of a column lies on the ground in most of the columns. Some of them will do; how
  // far apart is a prime number, since a sensor may leave every other column empty.
  constexpr int kColumnsApart = 7;
  const float limit = tangent(options.slope_deg);
  const int columns = image.columns();
  candidate_heights_.clear();
  candidate_heights_.reserve(static_cast<std::size_t>(columns / kColumnsApart + 1));
  for (int column = 0; column < columns; column += kColumnsApart) {
    for (int row = image.rows() - 1; row > 0; --row) {
      const int lower = row * columns + column;
      const int upper = lower - columns;
      if (image.range()[lower] <= 0.0F || image.range()[upper] <= 0.0F || image.height()[lower] >= 0.0F) continue;
      const float rise = std::abs(image.height()[upper] - image.height()[lower]);
      if (rise > limit * (image.horizontalRange()[upper] - image.horizontalRange()[lower])) continue;
      candidate_heights_.push_back(image.height()[lower]);
      break;
    }
  }
  if (candidate_heights_.empty()) return 0.0F;
  const auto middle = candidate_heights_.begin() + static_cast<std::ptrdiff_t>(candidate_heights_.size() / 2);
  std::nth_element(candidate_heights_.begin(), middle, candidate_heights_.end());
  return -*middle;
}

// Half way to where its lowest beam meets level ground, a column of a sensor that leans may see the first return of a
// wall, which is higher above level ground than ground can be by the slope from the sensor on.
void GroundDetection::beginWhereBeamsMeetGround(const std::vector<float>& lowest_tangents) {
  constexpr float kShareOfWay = 0.5F;
  constexpr float kFar_m = 1000.0F;
  for (std::size_t column = 0; column < lowest_tangents.size(); ++column) {
    const float fall = -lowest_tangents[column];
    last_range_[column] = fall > 0.0F ? std::min(kFar_m, kShareOfWay * sensor_height_ / fall) : kFar_m;
  }
}

void GroundDetection::grow(const PixelImage& image, const GroundOptions& options, std::size_t first_column,
                           std::size_t columns) {
  const GrowthLimits limits = {tangent(options.slope_deg), static_cast<float>(options.step_tolerance_m),
                               static_cast<float>(options.profile_tolerance_m)};
  for (int row = image.rows() - 1; row >= 0; --row) {
    const std::size_t begin = static_cast<std::size_t>(row) * static_cast<std::size_t>(image.columns()) + first_column;
    growRow(columns, limits,
            {image.range().data() + begin, image.horizontalRange().data() + begin, image.height().data() + begin,
             last_range_.data() + first_column, last_height_.data() + first_column,
             profile_height_.data() + first_column, states_.data() + begin});
  }
}

void GroundDetection::doubtFeet(const PixelImage& image, const SensorModel& sensor, const GroundOptions& options) {
  const auto columns = static_cast<std::size_t>(image.columns());
  obstacle_range_.assign(columns, 0.0F);
  obstacle_height_.assign(columns, std::numeric_limits<float>::infinity());
  FootLimits limits = {tangent(options.foot_angle_deg), static_cast<float>(options.foot_height_m), 0.0F};
  for (int row = 0; row < image.rows(); ++row) {
    // An upright surface is met that much higher by the beam above.
    if (row > 0) {
      limits.rise_of_range = tangent(sensor.elevations_deg[row - 1]) - tangent(sensor.elevations_deg[row]);
    }
    const std::size_t begin = static_cast<std::size_t>(row) * columns;
    internal::doubtFeet(columns, limits,
                        {image.horizontalRange().data() + begin, image.height().data() + begin, obstacle_range_.data(),
                         obstacle_height_.data(), states_.data() + begin});
  }
}

void GroundDetection::takeBackDoubts(const PixelImage& image, const SensorModel& sensor,
                                     std::vector<StructuralLabel>& labels) {
  constexpr double kFarApart_deg = 0.65;
  const auto is_far_below = [&](int row) {
    return sensor.elevations_deg[row - 1] - sensor.elevations_deg[row] >= kFarApart_deg;
  };
  bool any = false;
  for (int row = 1; row < image.rows(); ++row) any = any || is_far_below(row);
  if (!any) return;
  // How far what is taken back may be from the ground before it, and a slope beyond.
  constexpr float kLevel_m = 0.1F;
  constexpr float kLevelSlope = 0.02F;
  const auto columns = static_cast<std::size_t>(image.columns());
  last_range_.assign(columns, 0.0F);
  last_height_.assign(columns, -sensor_height_);
  for (int row = image.rows() - 1; row > 0; --row) {
    const bool is_far = is_far_below(row);
    const std::size_t begin = static_cast<std::size_t>(row) * columns;
    for (std::size_t column = 0; column < columns; ++column) {
      StructuralLabel& label = labels[begin + column];
      const float range = image.horizontalRange()[begin + column], height = image.height()[begin + column];
      if (is_far && label == StructuralLabel::NOISE && states_[begin + column] >= kDoubtfulState &&
          std::abs(height - last_height_[column]) <= kLevel_m + kLevelSlope * (range - last_range_[column])) {
        label = StructuralLabel::GROUND;
      }
      if (label == StructuralLabel::GROUND) {
        last_range_[column] = range;
        last_height_[column] = height;
      }
    }
  }
}

void GroundDetection::settle(const PixelImage& image, int row, bool smooths, NeighbourSums& sums,
                             std::vector<std::uint8_t>& ground) const {
  const auto columns = static_cast<std::size_t>(image.columns());
  const std::size_t begin = static_cast<std::size_t>(row) * columns;
  const std::uint8_t* const middle = states_.data() + begin;
  std::uint8_t* const result = ground.data() + begin;
  if (!smooths) {
    for (std::size_t column = 0; column < columns; ++column) result[column] = middle[column] == kGroundState ? 1 : 0;
    return;
  }
  const std::uint8_t* const above = row > 0 ? middle - columns : no_returns_.data();
  const std::uint8_t* const below = row + 1 < image.rows() ? middle + columns : no_returns_.data();
  sumColumns(columns, above, middle, below, sums.returns.data() + 1, sums.ground.data() + 1);
  // The neighbours over the azimuth seam.
  for (std::vector<std::uint8_t>* padded : {&sums.returns, &sums.ground}) {
    padded->front() = (*padded)[columns];
    padded->back() = (*padded)[1];
  }
  settleRow(columns, middle, sums.returns.data(), sums.ground.data(), result);
}

}  // namespace saw_ndt::internal
