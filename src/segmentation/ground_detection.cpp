#include "saw_ndt/segmentation/ground_detection.h"

#include <algorithm>
#include <cmath>

#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"
#include "segmentation/vector_code.h"

namespace saw_ndt {
namespace {

// States of a pixel while ground grows, each implying those before it. Doubtful: near the profile, yet too steep a step
// from the last ground return.
constexpr std::uint8_t kReturn = 1;
constexpr std::uint8_t kDoubtful = 2;
constexpr std::uint8_t kGround = 3;

float tangent(double degrees) { return static_cast<float>(std::tan(radiansFromDegrees(degrees))); }

struct GrowthLimits {
  float slope;
  float step_tolerance;
  float profile_tolerance;
};

// Lets ground grow by one row in every column. Without branches,.
SAW_NDT_VECTOR_CODE void growRow(std::size_t columns, const GrowthLimits limits, const float* __restrict range,
                                 const float* __restrict horizontal_range, const float* __restrict height,
                                 float* __restrict last_range, float* __restrict last_height,
                                 float* __restrict profile_height, std::uint8_t* __restrict states) {
  for (std::size_t column = 0; column < columns; ++column) {
    const float z = height[column];
    const float beyond = horizontal_range[column] - last_range[column];
    const float advance = beyond > 0.0F ? beyond : 0.0F;
    const float reach = limits.slope * advance;
    const float above_profile = z - profile_height[column];
    const float step = z - last_height[column];
    const int has_return = range[column] > 0.0F ? 1 : 0;
    const int near_profile = std::abs(above_profile) <= limits.profile_tolerance + reach ? has_return : 0;
    const int is_ground = std::abs(step) <= limits.step_tolerance + reach ? near_profile : 0;
    // The profile rises no faster than the slope, and falls at once: the lowest returns are the surest.
    const float rise = above_profile < reach ? above_profile : reach;
    last_range[column] += is_ground != 0 ? advance : 0.0F;
    last_height[column] = is_ground != 0 ? z : last_height[column];
    profile_height[column] += is_ground != 0 ? rise : 0.0F;
    states[column] = static_cast<std::uint8_t>(has_return + near_profile + is_ground);
  }
}

// How many of three pixels one above the other have returns, and how many are ground.
SAW_NDT_VECTOR_CODE void sumColumns(std::size_t columns, const std::uint8_t* __restrict above,
                                    const std::uint8_t* __restrict middle, const std::uint8_t* __restrict below,
                                    std::uint8_t* __restrict returns, std::uint8_t* __restrict ground) {
  const auto is = [](bool condition) { return static_cast<std::uint8_t>(condition ? 1 : 0); };
  for (std::size_t column = 0; column < columns; ++column) {
    returns[column] = static_cast<std::uint8_t>(is(above[column] >= kReturn) + is(middle[column] >= kReturn) +
                                                is(below[column] >= kReturn));
    ground[column] = static_cast<std::uint8_t>(is(above[column] == kGround) + is(middle[column] == kGround) +
                                               is(below[column] == kGround));
  }
}

// Ground stays where half of the eight neighbours that have returns are ground; what is doubtful joins where more than
// three quarters are. The sums have one column more at either side.
SAW_NDT_VECTOR_CODE void settleRow(std::size_t columns, const std::uint8_t* __restrict states,
                                   const std::uint8_t* __restrict returns, const std::uint8_t* __restrict ground,
                                   std::uint8_t* __restrict result) {
  for (std::size_t column = 0; column < columns; ++column) {
    const std::uint8_t is_ground = states[column] == kGround ? 1 : 0;
    const std::uint8_t is_doubtful = states[column] == kDoubtful ? 1 : 0;
    const auto neighbours = static_cast<std::uint8_t>(returns[column] + returns[column + 1] + returns[column + 2] - 1);
    const auto of_ground =
        static_cast<std::uint8_t>(ground[column] + ground[column + 1] + ground[column + 2] - is_ground);
    const std::uint8_t stays = static_cast<std::uint8_t>(2 * of_ground) >= neighbours ? is_ground : 0;
    const std::uint8_t joins =
        static_cast<std::uint8_t>(4 * of_ground) > static_cast<std::uint8_t>(3 * neighbours) ? is_doubtful : 0;
    result[column] = stays | joins;
  }
}

}  // namespace

void GroundOptions::check() const {
  const auto in = [](double value, double least, double greatest) { return value >= least && value <= greatest; };
  checkOption(in(inclination_limit_deg, 0.0, 90.0), "inclination_limit_deg", inclination_limit_deg, "0 to 90");
  checkOption(in(inclination_top_elevation_deg, -90.0, 90.0), "inclination_top_elevation_deg",
              inclination_top_elevation_deg, "-90 to 90");
  checkOption(in(sensor_height_m, 0.0, 100.0), "sensor_height_m", sensor_height_m, "0 to 100");
  checkOption(in(slope_deg, 0.0, 60.0), "slope_deg", slope_deg, "0 to 60");
  checkOption(in(step_tolerance_m, 0.0, 10.0), "step_tolerance_m", step_tolerance_m, "0 to 10");
  checkOption(in(profile_tolerance_m, 0.0, 10.0), "profile_tolerance_m", profile_tolerance_m, "0 to 10");
}

void GroundDetection::detect(const RangeImage& image, const SensorModel& sensor, const GroundOptions& options,
                             std::vector<std::uint8_t>& ground) {
  if (options.rule == GroundRule::Inclination) {
    detectByInclination(image, sensor, options, ground);
    return;
  }
  ground.resize(image.range().size());
  grow(image, options);
  if (options.smooths) {
    smooth(image, ground);
  } else {
    for (std::size_t pixel = 0; pixel < states_.size(); ++pixel) ground[pixel] = states_[pixel] == kGround ? 1 : 0;
  }
}

void GroundDetection::detectByInclination(const RangeImage& image, const SensorModel& sensor,
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

float GroundDetection::estimatedSensorHeight(const RangeImage& image, const GroundOptions& options) {
  if (options.sensor_height_m > 0.0) return static_cast<float>(options.sensor_height_m);
  // The lowest level pair of returns of each column lies on the ground in most of the columns.
  const float limit = tangent(options.slope_deg);
  const int columns = image.columns();
  candidate_heights_.clear();
  candidate_heights_.reserve(static_cast<std::size_t>(columns));
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

void GroundDetection::grow(const RangeImage& image, const GroundOptions& options) {
  const auto columns = static_cast<std::size_t>(image.columns());
  const float sensor_height = estimatedSensorHeight(image, options);
  last_range_.assign(columns, 0.0F);
  last_height_.assign(columns, -sensor_height);
  profile_height_.assign(columns, -sensor_height);
  states_.resize(image.range().size());
  const GrowthLimits limits = {tangent(options.slope_deg), static_cast<float>(options.step_tolerance_m),
                               static_cast<float>(options.profile_tolerance_m)};
  for (int row = image.rows() - 1; row >= 0; --row) {
    const std::size_t begin = static_cast<std::size_t>(row) * columns;
    growRow(columns, limits, image.range().data() + begin, image.horizontalRange().data() + begin,
            image.height().data() + begin, last_range_.data(), last_height_.data(), profile_height_.data(),
            states_.data() + begin);
  }
}

void GroundDetection::smooth(const RangeImage& image, std::vector<std::uint8_t>& ground) {
  const int rows = image.rows();
  const auto columns = static_cast<std::size_t>(image.columns());
  padded_returns_.resize(columns + 2);
  padded_ground_.resize(columns + 2);
  for (int row = 0; row < rows; ++row) {
    const std::uint8_t* middle = states_.data() + static_cast<std::size_t>(row) * columns;
    no_returns_.assign(columns, 0);
    const std::uint8_t* above = row > 0 ? middle - columns : no_returns_.data();
    const std::uint8_t* below = row + 1 < rows ? middle + columns : no_returns_.data();
    sumColumns(columns, above, middle, below, padded_returns_.data() + 1, padded_ground_.data() + 1);
    // The neighbours over the azimuth seam.
    for (std::vector<std::uint8_t>* padded : {&padded_returns_, &padded_ground_}) {
      padded->front() = (*padded)[columns];
      padded->back() = (*padded)[1];
    }
    settleRow(columns, middle, padded_returns_.data(), padded_ground_.data(),
              ground.data() + static_cast<std::size_t>(row) * columns);
  }
}

}  // namespace saw_ndt
