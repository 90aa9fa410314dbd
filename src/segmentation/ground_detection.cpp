#include "saw_ndt/segmentation/ground_detection.h"

#include <algorithm>
#include <cmath>

#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt {
namespace {

// States of a pixel while ground grows. Doubtful: near the profile, yet too steep a step from the last ground return.
constexpr std::uint8_t kNotGround = 0;
constexpr std::uint8_t kGround = 1;
constexpr std::uint8_t kDoubtful = 2;

float tangent(double degrees) { return static_cast<float>(std::tan(radiansFromDegrees(degrees))); }

}  // namespace

void GroundOptions::check() const {
  const auto in = [](double value, double least, double greatest) { return value >= least && value <= greatest; };
  checkOption(in(inclination_limit_deg, 0.0, 90.0), "inclination_limit_deg", inclination_limit_deg, "0 to 90");
  checkOption(in(inclination_top_elevation_deg, -90.0, 90.0), "inclination_top_elevation_deg",
              inclination_top_elevation_deg, "-90 to 90");
  checkOption(in(sensor_height_m, 0.0, 100.0), "sensor_height_m", sensor_height_m, "0 to 100");
  checkOption(in(step_slope_deg, 0.0, 60.0), "step_slope_deg", step_slope_deg, "0 to 60");
  checkOption(in(step_tolerance_m, 0.0, 10.0), "step_tolerance_m", step_tolerance_m, "0 to 10");
  checkOption(in(profile_slope_deg, 0.0, 60.0), "profile_slope_deg", profile_slope_deg, "0 to 60");
  checkOption(in(profile_tolerance_m, 0.0, 10.0), "profile_tolerance_m", profile_tolerance_m, "0 to 10");
  checkOption(smoothing_passes >= 0 && smoothing_passes <= 10, "smoothing_passes", smoothing_passes, "0 to 10");
}

void GroundDetection::detect(const RangeImage& image, const SensorModel& sensor, const GroundOptions& options,
                             std::vector<std::uint8_t>& ground) {
  ground.assign(image.range().size(), 0);
  if (options.rule == GroundRule::Inclination) {
    detectByInclination(image, sensor, options, ground);
    return;
  }
  grow(image, options, ground);
  for (int pass = 0; pass < options.smoothing_passes; ++pass) smooth(image, ground);
  for (std::uint8_t& state : ground) state = state == kGround ? 1 : 0;
}

void GroundDetection::detectByInclination(const RangeImage& image, const SensorModel& sensor,
                                          const GroundOptions& options, std::vector<std::uint8_t>& ground) {
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

float GroundDetection::estimatedSensorHeight(const RangeImage& image, const GroundOptions& options) {
  if (options.sensor_height_m > 0.0) return static_cast<float>(options.sensor_height_m);
  // The lowest level pair of returns of each column lies on the ground in most of the columns.
  const float limit = tangent(options.step_slope_deg);
  const int columns = image.columns();
  candidate_heights_.clear();
  for (int column = 0; column < columns; ++column) {
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

void GroundDetection::grow(const RangeImage& image, const GroundOptions& options, std::vector<std::uint8_t>& ground) {
  const float step_slope = tangent(options.step_slope_deg);
  const float profile_slope = tangent(options.profile_slope_deg);
  const auto step_tolerance = static_cast<float>(options.step_tolerance_m);
  const auto profile_tolerance = static_cast<float>(options.profile_tolerance_m);
  const int columns = image.columns();
  const float sensor_height = estimatedSensorHeight(image, options);
  last_range_.assign(columns, 0.0F);
  last_height_.assign(columns, -sensor_height);
  profile_height_.assign(columns, -sensor_height);

  for (int row = image.rows() - 1; row >= 0; --row) {
    for (int column = 0; column < columns; ++column) {
      const int pixel = row * columns + column;
      if (image.range()[pixel] <= 0.0F) continue;
      const float range = image.horizontalRange()[pixel];
      const float height = image.height()[pixel];
      const float advance = std::max(range - last_range_[column], 0.0F);
      const float above_profile = height - profile_height_[column];
      const float follow = profile_slope * advance;
      if (std::abs(above_profile) > profile_tolerance + follow) continue;
      ground[pixel] = kDoubtful;
      if (std::abs(height - last_height_[column]) > step_tolerance + step_slope * advance) continue;
      ground[pixel] = kGround;
      last_range_[column] += advance;
      last_height_[column] = height;
      profile_height_[column] += std::clamp(above_profile, -follow, follow);
    }
  }
}

void GroundDetection::smooth(const RangeImage& image, std::vector<std::uint8_t>& ground) {
  const int rows = image.rows();
  const int columns = image.columns();
  const std::size_t padded = static_cast<std::size_t>(columns) + 2;
  before_ = ground;
  column_returns_.resize(padded);
  column_ground_.resize(padded);
  for (int row = 0; row < rows; ++row) {
    // Sums over the three rows, one column of the image either side over the seam.
    std::fill(column_returns_.begin(), column_returns_.end(), std::uint8_t{0});
    std::fill(column_ground_.begin(), column_ground_.end(), std::uint8_t{0});
    for (int other = std::max(row - 1, 0); other <= std::min(row + 1, rows - 1); ++other) {
      const float* range = image.range().data() + other * columns;
      const std::uint8_t* state = before_.data() + other * columns;
      for (int column = 0; column < columns; ++column) {
        column_returns_[column + 1] = static_cast<std::uint8_t>(column_returns_[column + 1] + (range[column] > 0.0F));
        column_ground_[column + 1] = static_cast<std::uint8_t>(column_ground_[column + 1] + (state[column] == kGround));
      }
    }
    column_returns_[0] = column_returns_[columns];
    column_returns_[columns + 1] = column_returns_[1];
    column_ground_[0] = column_ground_[columns];
    column_ground_[columns + 1] = column_ground_[1];

    const std::uint8_t* state = before_.data() + row * columns;
    std::uint8_t* result = ground.data() + row * columns;
    for (int column = 0; column < columns; ++column) {
      const int is_ground = state[column] == kGround ? 1 : 0;
      const int returns = column_returns_[column] + column_returns_[column + 1] + column_returns_[column + 2] - 1;
      const int of_ground =
          column_ground_[column] + column_ground_[column + 1] + column_ground_[column + 2] - is_ground;
      const bool stays = state[column] == kGround && 2 * of_ground >= returns;
      const bool joins = state[column] == kDoubtful && 4 * of_ground > 3 * returns;
      const bool doubtful = state[column] != kNotGround;
      result[column] = stays || joins ? kGround : (doubtful ? kDoubtful : kNotGround);
    }
  }
}

}  // namespace saw_ndt
