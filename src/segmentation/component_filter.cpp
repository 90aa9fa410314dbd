#include "saw_ndt/segmentation/component_filter.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt {
namespace {

constexpr std::int32_t kNoRun = -1;

// LeGO-LOAM connects ranges d1 >= d2, an angle a apart, where atan2(d2 sin a, d1 - d2 cos a) > t. As d1 > d2 cos a,
// that is d2 (sin a / tan t + cos a) > d1; this is the factor of d2.
float connectionRatio(double apart_deg, double threshold_deg) {
  const double apart = radiansFromDegrees(apart_deg);
  return static_cast<float>(std::sin(apart) / std::tan(radiansFromDegrees(threshold_deg)) + std::cos(apart));
}

inline bool connected(float first, float second, float ratio) {
  return std::min(first, second) * ratio > std::max(first, second);
}

}  // namespace

void ComponentOptions::check() const {
  checkOption(connection_angle_deg > 0.0 && connection_angle_deg < 90.0, "connection_angle_deg", connection_angle_deg,
              "above 0 and below 90");
  checkOption(minimum_pixels >= 1, "minimum_pixels", minimum_pixels, "at least 1");
  checkOption(minimum_pixels_tall >= 1, "minimum_pixels_tall", minimum_pixels_tall, "at least 1");
  checkOption(minimum_rings_tall >= 1, "minimum_rings_tall", minimum_rings_tall, "at least 1");
}

void ComponentFilter::label(const RangeImage& image, const SensorModel& sensor, const std::vector<std::uint8_t>& ground,
                            const ComponentOptions& options, std::vector<StructuralLabel>& labels) {
  const int columns = image.columns();
  runs_.clear();
  run_of_pixel_.resize(image.range().size());
  const float along = connectionRatio(360.0 / columns, options.connection_angle_deg);
  for (int row = 0; row < image.rows(); ++row) {
    connectRow(image, ground, row, along);
    if (row == 0) continue;
    const double apart_deg = sensor.elevations_deg[row - 1] - sensor.elevations_deg[row];
    connectRows(image, row, connectionRatio(apart_deg, options.connection_angle_deg));
  }

  labels.resize(image.range().size());
  for (std::size_t pixel = 0; pixel < labels.size(); ++pixel) {
    labels[pixel] = ground[pixel] != 0 ? StructuralLabel::Ground : StructuralLabel::Noise;
  }
  for (std::size_t index = 0; index < runs_.size(); ++index) {
    const Run& component = runs_[rootOf(static_cast<std::int32_t>(index))];
    // 4-connected: the rows of a component have no gap.
    const int rings = component.bottom_row - component.top_row + 1;
    const bool tall = component.pixels >= options.minimum_pixels_tall && rings >= options.minimum_rings_tall;
    if (!tall && component.pixels < options.minimum_pixels) continue;
    std::fill(labels.begin() + runs_[index].first_pixel, labels.begin() + runs_[index].end_pixel,
              StructuralLabel::NonGround);
  }
}

void ComponentFilter::connectRow(const RangeImage& image, const std::vector<std::uint8_t>& ground, int row,
                                 float ratio) {
  const std::vector<float>& range = image.range();
  const std::int32_t begin = row * image.columns();
  const std::int32_t end = begin + image.columns();
  const auto runs_before = static_cast<std::int32_t>(runs_.size());
  bool open = false;
  for (std::int32_t pixel = begin; pixel < end; ++pixel) {
    if (range[pixel] <= 0.0F || ground[pixel] != 0) {
      run_of_pixel_[pixel] = kNoRun;
      open = false;
      continue;
    }
    if (!open || !connected(range[pixel - 1], range[pixel], ratio)) {
      const auto index = static_cast<std::int32_t>(runs_.size());
      runs_.push_back({pixel, pixel, index, 0, row, row});
      open = true;
    }
    Run& run = runs_.back();
    run.end_pixel = pixel + 1;
    ++run.pixels;
    run_of_pixel_[pixel] = static_cast<std::int32_t>(runs_.size()) - 1;
  }
  const auto last_run = static_cast<std::int32_t>(runs_.size()) - 1;
  const bool over_seam = run_of_pixel_[begin] != kNoRun && run_of_pixel_[end - 1] != kNoRun;
  if (over_seam && connected(range[begin], range[end - 1], ratio)) unite(runs_before, last_run);
}

void ComponentFilter::connectRows(const RangeImage& image, int row, float ratio) {
  const std::vector<float>& range = image.range();
  const int columns = image.columns();
  std::int32_t last_upper = kNoRun;
  std::int32_t last_lower = kNoRun;
  for (std::int32_t pixel = row * columns; pixel < (row + 1) * columns; ++pixel) {
    const std::int32_t lower = run_of_pixel_[pixel];
    const std::int32_t upper = run_of_pixel_[pixel - columns];
    if (lower == kNoRun || upper == kNoRun || (lower == last_lower && upper == last_upper)) continue;
    if (!connected(range[pixel], range[pixel - columns], ratio)) continue;
    unite(upper, lower);
    last_upper = upper;
    last_lower = lower;
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
  if (first == second) return;
  if (runs_[first].pixels < runs_[second].pixels) std::swap(first, second);
  Run& root = runs_[first];
  Run& child = runs_[second];
  child.parent = first;
  root.pixels += child.pixels;
  root.top_row = std::min(root.top_row, child.top_row);
  root.bottom_row = std::max(root.bottom_row, child.bottom_row);
}

}  // namespace saw_ndt
