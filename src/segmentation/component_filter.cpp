#include "saw_ndt/segmentation/component_filter.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"
#include "segmentation/vector_code.h"

namespace saw_ndt {
namespace {

// Runs are numbered from 2: what a pixel of no run holds instead.
constexpr std::int32_t kNoReturn = 0;
constexpr std::int32_t kGroundPixel = 1;
constexpr std::int32_t kFirstRun = 2;

// What a pixel that may be part of a component has: a return that is no ground; a connection to the pixel before it in
// its row; one to the pixel above it.
constexpr std::int32_t kActive = 1;
constexpr std::int32_t kLinkedBefore = 2;
constexpr std::int32_t kLinkedAbove = 4;

// LeGO-LOAM connects ranges d1 >= d2, an angle a apart, where atan2(d2 sin a, d1 - d2 cos a) > t. As d1 > d2 cos a,
// that is d2 (sin a / tan t + cos a) > d1; this is the factor of d2.
float connectionRatio(double apart_deg, double threshold_deg) {
  const double apart = radiansFromDegrees(apart_deg);
  return static_cast<float>(std::sin(apart) / std::tan(radiansFromDegrees(threshold_deg)) + std::cos(apart));
}

inline bool connected(float first, float second, float ratio) {
  const float nearer = first < second ? first : second;
  const float farther = first < second ? second : first;
  return nearer * ratio > farther;  // false where the nearer is no return, with range 0
}

// Ranges with those of ground taken out.
SAW_NDT_VECTOR_CODE void takeOutGround(std::size_t count, const float* __restrict range,
                                       const std::uint8_t* __restrict ground, float* __restrict obstacle_range) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t is_ground = ground[i];
    obstacle_range[i] = is_ground != 0 ? 0.0F : range[i];
  }
}

// The links of pixels with those before them in their row and those above them; `range` begins one pixel early. Without
// branches,.
SAW_NDT_VECTOR_CODE void linkPixels(std::size_t count, float ratio_along, float ratio_across,
                                    const float* __restrict range, const float* __restrict above,
                                    std::int32_t* __restrict links) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t active = range[i + 1] > 0.0F ? kActive : 0;
    const std::int32_t along = connected(range[i + 1], range[i], ratio_along) ? kLinkedBefore : 0;
    const std::int32_t across = connected(range[i + 1], above[i], ratio_across) ? kLinkedAbove : 0;
    links[i] = active + along + across;
  }
}

}  // namespace

void ComponentOptions::check() const {
  checkOption(connection_angle_deg > 0.0 && connection_angle_deg < 90.0, "connection_angle_deg", connection_angle_deg,
              "above 0 and below 90");
  checkOption(minimum_points >= 1, "minimum_points", minimum_points, "at least 1");
  checkOption(minimum_points_tall >= 1, "minimum_points_tall", minimum_points_tall, "at least 1");
  checkOption(minimum_rings_tall >= 1, "minimum_rings_tall", minimum_rings_tall, "at least 1");
}

void ComponentFilter::label(const RangeImage& image, const SensorModel& sensor, const std::vector<std::uint8_t>& ground,
                            const ComponentOptions& options, std::vector<StructuralLabel>& labels) {
  const auto columns = static_cast<std::size_t>(image.columns());
  const std::size_t pixels = image.range().size();
  run_of_pixel_.resize(pixels);
  runs_.resize(pixels + kFirstRun);
  links_.resize(columns);
  above_.assign(columns + 1, 0.0F);  // nothing is above the top row
  run_end_ = kFirstRun;
  const float along = connectionRatio(360.0 / image.columns(), options.connection_angle_deg);
  for (int row = 0; row < image.rows(); ++row) {
    const std::size_t begin = static_cast<std::size_t>(row) * columns;
    current_.resize(columns + 1);
    takeOutGround(columns, image.range().data() + begin, ground.data() + begin, current_.data() + 1);
    current_[0] = current_[columns];  // the pixel before the first is the last: over the azimuth seam
    const double apart_deg = row > 0 ? sensor.elevations_deg[row - 1] - sensor.elevations_deg[row] : 0.0;
    const float across = connectionRatio(apart_deg, options.connection_angle_deg);
    linkPixels(columns, along, across, current_.data(), above_.data() + 1, links_.data());
    connectRow(row, image, ground.data() + begin);
    std::swap(current_, above_);
  }

  chooseComponents(options);
  labels.resize(pixels);
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) labels[pixel] = label_of_run_[run_of_pixel_[pixel]];
}

void ComponentFilter::connectRow(int row, const RangeImage& image, const std::uint8_t* ground) {
  const std::int32_t columns = image.columns();
  const std::uint16_t* const returns = image.returns().data() + static_cast<std::ptrdiff_t>(row) * columns;
  const std::int32_t first_run = run_end_;
  std::int32_t run = first_run - 1;
  std::int32_t* const run_of_pixel = run_of_pixel_.data() + static_cast<std::ptrdiff_t>(row) * columns;
  const std::int32_t* const links = links_.data();
  Run* const runs = runs_.data();
  std::int32_t last_above = 0;
  for (std::int32_t column = 0; column < columns; ++column) {
    const std::int32_t link = links[column];
    if (link == 0) {
      run_of_pixel[column] = ground[column] != 0 ? kGroundPixel : kNoReturn;
      continue;
    }
    if (column == 0 || (link & kLinkedBefore) == 0) {
      ++run;
      runs[run] = {run, 0, row, row};
      last_above = 0;
    }
    runs[run].points += returns[column];
    run_of_pixel[column] = run;
    if ((link & kLinkedAbove) == 0) continue;
    const std::int32_t above = run_of_pixel[column - columns];
    if (above != last_above) unite(above, run);
    last_above = above;
  }
  run_end_ = run + 1;
  if ((links[0] & kLinkedBefore) != 0) unite(first_run, run);
}

void ComponentFilter::chooseComponents(const ComponentOptions& options) {
  // A parent has the smaller number: from the last run on, each hands on to its parent what it holds.
  for (std::int32_t index = run_end_ - 1; index >= kFirstRun; --index) {
    const Run& run = runs_[index];
    if (run.parent == index) continue;
    Run& parent = runs_[run.parent];
    parent.points += run.points;
    parent.bottom_row = std::max(parent.bottom_row, run.bottom_row);
  }
  label_of_run_.reserve(runs_.size());  // the number of runs changes from scan to scan of one size
  label_of_run_.resize(static_cast<std::size_t>(run_end_));
  label_of_run_[kNoReturn] = StructuralLabel::Noise;
  label_of_run_[kGroundPixel] = StructuralLabel::Ground;
  for (std::int32_t index = kFirstRun; index < run_end_; ++index) {
    const Run& run = runs_[index];
    if (run.parent != index) {
      label_of_run_[index] = label_of_run_[run.parent];
      continue;
    }
    // 4-connected: the rows of a component have no gap, and its root is in the topmost.
    const int rings = run.bottom_row - run.top_row + 1;
    const bool tall = run.points >= options.minimum_points_tall && rings >= options.minimum_rings_tall;
    label_of_run_[index] =
        tall || run.points >= options.minimum_points ? StructuralLabel::NonGround : StructuralLabel::Noise;
  }
}

std::int32_t ComponentFilter::rootOf(std::int32_t run) {
  while (runs_[run].parent != run) {
    runs_[run].parent = runs_[runs_[run].parent].parent;
    run = runs_[run].parent;
  }
  return run;
}

void ComponentFilter::unite(std::int32_t first, std::int32_t second) {
  first = rootOf(first);
  second = rootOf(second);
  if (first < second) {
    runs_[second].parent = first;
  } else {
    runs_[first].parent = second;
  }
}

}  // namespace saw_ndt
