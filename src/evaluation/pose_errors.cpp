#include "saw_ndt/evaluation/pose_errors.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "evaluation/statistics.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt {

using namespace internal;

namespace {

using Places = std::vector<std::pair<std::size_t, std::size_t>>;

RelativePoseError sizeOf(const Eigen::Isometry3d& E) {
  RelativePoseError error;
  error.translation_m = E.translation().norm();
  error.rotation_deg = degreesFromRadians(rotationAngle(E.linear()));
  error.full = (E.matrix() - Eigen::Matrix4d::Identity()).norm();
  return error;
}

/// Length of the way from the pose before to each; 0 for the first.
std::vector<double> stepsOf(const std::vector<PosePair>& pairs, bool of_reference) {
  const auto positionOf = [&](const PosePair& pair) -> Eigen::Vector3d {
    return (of_reference ? pair.T_map_reference : pair.T_map_estimate).translation();
  };
  std::vector<double> steps_m(pairs.size(), 0.0);
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    steps_m[i] = (positionOf(pairs[i]) - positionOf(pairs[i - 1])).norm();
  }
  return steps_m;
}

Places framesApart(std::size_t poses, std::size_t delta, bool all_pairs) {
  Places places;
  for (std::size_t i = 0; i < poses && delta < poses - i; i += all_pairs ? 1 : delta) places.emplace_back(i, i + delta);
  return places;
}

Places metresApart(const std::vector<double>& steps_m, double delta_m, double tolerance_m) {
  std::vector<double> ways_m(steps_m.size());
  std::partial_sum(steps_m.begin(), steps_m.end(), ways_m.begin());
  Places places;
  for (std::size_t i = 0; i + 1 < ways_m.size(); ++i) {
    const auto first = ways_m.begin() + static_cast<std::ptrdiff_t>(i) + 1;
    const auto offBy = [&](double way_m) { return std::abs(way_m - ways_m[i] - delta_m); };
    auto nearest = std::lower_bound(first, ways_m.end(), ways_m[i] + delta_m);
    if (nearest == ways_m.end() || (nearest != first && offBy(*(nearest - 1)) <= offBy(*nearest))) --nearest;
    // Of poses that stand at one place, the first.
    nearest = std::lower_bound(first, nearest, *nearest);
    if (offBy(*nearest) <= tolerance_m) places.emplace_back(i, static_cast<std::size_t>(nearest - ways_m.begin()));
  }
  return places;
}

Places metresOneAfterAnother(const std::vector<double>& steps_m, double delta_m) {
  Places places;
  std::size_t ends = 0, last = 0;
  double way_m = 0.0;
  for (std::size_t i = 0; i < steps_m.size(); ++i) {
    way_m += steps_m[i];
    if (way_m < delta_m) continue;
    if (ends++ > 0) places.emplace_back(last, i);
    last = i;
    way_m = 0.0;
  }
  return places;
}

}  // namespace

ErrorStatistics errorStatistics(const std::vector<double>& errors) {
  ErrorStatistics statistics;
  statistics.mean = mean(errors);
  double squared_deviations = 0.0;
  for (const double error : errors) {
    statistics.sse += error * error;
    squared_deviations += (error - statistics.mean) * (error - statistics.mean);
  }
  const auto count = static_cast<double>(errors.size());
  statistics.rmse = std::sqrt(statistics.sse / count);
  statistics.median = median(errors);
  statistics.std = std::sqrt(squared_deviations / count);
  const auto [least, greatest] = std::minmax_element(errors.begin(), errors.end());
  statistics.min = *least;
  statistics.max = *greatest;
  return statistics;
}

PoseErrorStatistics statisticsOf(const std::vector<RelativePoseError>& errors) {
  std::vector<double> translations_m, rotations_deg, full;
  for (const RelativePoseError& error : errors) {
    translations_m.push_back(error.translation_m);
    rotations_deg.push_back(error.rotation_deg);
    full.push_back(error.full);
  }
  return {errorStatistics(translations_m), errorStatistics(rotations_deg), errorStatistics(full)};
}

PoseErrorStatistics absolutePoseErrors(const std::vector<PosePair>& pairs) {
  std::vector<RelativePoseError> errors;
  for (const PosePair& pair : pairs) errors.push_back(sizeOf(pair.T_map_estimate.inverse() * pair.T_map_reference));
  return statisticsOf(errors);
}

void RelativeErrorOptions::check() const {
  if (unit == Unit::FRAMES) {
    checkOption(delta >= 1.0 && delta == std::floor(delta) && delta <= 1e9, "delta", delta, "a whole number from 1");
  } else {
    checkOption(delta > 0.0 && std::isfinite(delta), "delta", delta, "positive");
  }
  checkOption(relative_tolerance >= 0.0 && std::isfinite(relative_tolerance), "relative_tolerance", relative_tolerance,
              "0 or greater");
}

std::vector<RelativePoseError> relativePoseErrors(const std::vector<PosePair>& pairs,
                                                  const RelativeErrorOptions& options) {
  options.check();
  const bool by_frames = options.unit == RelativeErrorOptions::Unit::FRAMES;
  Places places;
  if (by_frames) {
    places = framesApart(pairs.size(), static_cast<std::size_t>(options.delta), options.all_pairs);
  } else {
    const std::vector<double> steps_m = stepsOf(pairs, options.way_of_reference);
    places = options.all_pairs ? metresApart(steps_m, options.delta, options.relative_tolerance * options.delta)
                               : metresOneAfterAnother(steps_m, options.delta);
  }
  if (places.empty()) {
    std::ostringstream reason;
    reason << "no relative error: no two of the " << pairs.size() << " poses are " << options.delta
           << (by_frames ? " frames" : " m") << " apart";
    throw std::invalid_argument(reason.str());
  }
  std::vector<RelativePoseError> errors;
  for (const auto& [first, last] : places) {
    const PosePair &a = pairs[first], &b = pairs[last];
    const Eigen::Isometry3d T_reference = a.T_map_reference.inverse() * b.T_map_reference;
    const Eigen::Isometry3d T_estimate = a.T_map_estimate.inverse() * b.T_map_estimate;
    RelativePoseError error = sizeOf(T_reference.inverse() * T_estimate);
    error.first = first;
    error.last = last;
    errors.push_back(error);
  }
  return errors;
}

}  // namespace saw_ndt
