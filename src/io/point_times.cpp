#include "io/point_times.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "common/no_return.h"

namespace saw_ndt::internal {

namespace {

constexpr double kShortestScan_s = 0.01;
constexpr double kLongestScan_s = 1.5;
// Seconds since 1970 in the years 2001 to 2100.
constexpr double kFirstEpoch_s = 1.0e9;
constexpr double kLastEpoch_s = 4.1e9;

bool isFiniteReturn(const LidarPoint& point) {
  return std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z) && isReturn(&point.x);
}

/// What a time is multiplied by to be seconds.
double secondsPerUnit(double span, double greatest, bool whole_numbers) {
  constexpr double kUnits[] = {1.0, 1e-3, 1e-6, 1e-9};
  const int first = whole_numbers ? 1 : 0;
  for (int i = first; i < 4; ++i) {
    if (span * kUnits[i] >= kShortestScan_s && span * kUnits[i] <= kLongestScan_s) return kUnits[i];
  }
  for (int i = first; i < 4; ++i) {
    if (greatest * kUnits[i] >= kFirstEpoch_s && greatest * kUnits[i] <= kLastEpoch_s) return kUnits[i];
  }
  if (!whole_numbers) return 1.0;
  double best = kUnits[first];
  const auto distance = [&](double unit) { return std::abs(std::log(span * unit / 0.1)); };
  for (int i = first; i < 4; ++i) {
    if (distance(kUnits[i]) < distance(best)) best = kUnits[i];
  }
  return best;
}

}  // namespace

void makeSeconds(std::vector<double>& times, const std::vector<LidarPoint>& points, bool whole_numbers) {
  double least = std::numeric_limits<double>::infinity(), greatest = -least;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!std::isfinite(times[i]) || !isFiniteReturn(points[i])) continue;
    least = std::min(least, times[i]);
    greatest = std::max(greatest, times[i]);
  }
  if (!(greatest > least)) return times.clear();
  const double seconds = secondsPerUnit(greatest - least, greatest, whole_numbers);
  if (seconds != 1.0) {
    for (double& time : times) time *= seconds;
  }
}

std::vector<std::uint16_t> ringsFrom(const std::vector<double>& numbers, const std::vector<LidarPoint>& points,
                                     double greatest) {
  std::vector<std::uint16_t> rings(numbers.size());
  std::optional<double> first;
  bool differ = false;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const double number = numbers[i];
    const bool is_ring = number >= 0.0 && number <= greatest && number == std::floor(number);
    if (is_ring) rings[i] = static_cast<std::uint16_t>(number);
    if (!isFiniteReturn(points[i])) continue;
    if (!is_ring) return {};
    if (!first) first = number;
    differ = differ || number != *first;
  }
  return differ ? rings : std::vector<std::uint16_t>();
}

}  // namespace saw_ndt::internal
