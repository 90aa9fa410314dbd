#include "scan_faults.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "saw_ndt/common/geometry.h"
#include "simulation/random_numbers.h"

namespace saw_ndt {

void blockSector(std::vector<LidarPoint>& points, double start_rad, double share) {
  const auto blocked = [&](const LidarPoint& point) {
    double from_start = std::fmod(std::atan2(point.y, point.x) - start_rad, 2.0 * kPi);
    if (from_start < 0.0) from_start += 2.0 * kPi;
    return from_start < share * 2.0 * kPi;
  };
  points.erase(std::remove_if(points.begin(), points.end(), blocked), points.end());
}

void rainOn(std::vector<LidarPoint>& points, double share, std::uint64_t seed) {
  constexpr double kMeanRange_m = 4.0, kLeastRange_m = 1.0;
  SceneRandom random(seed);
  for (LidarPoint& point : points) {
    if (!random.chance(share)) continue;
    const double range_m = std::max(kLeastRange_m, -kMeanRange_m * std::log(random.uniform(1e-9, 1.0)));
    const float norm_m = positionOf(point).norm();
    // What stands nearer than the droplet hides it.
    if (range_m < norm_m) positionOf(point) *= static_cast<float>(range_m) / norm_m;
  }
}

void loseReturns(std::vector<LidarPoint>& points, double share, std::uint64_t seed) {
  SceneRandom random(seed);
  points.erase(std::remove_if(points.begin(), points.end(), [&](const LidarPoint&) { return random.chance(share); }),
               points.end());
}

void moveSensor(std::vector<LidarPoint>& points, const Eigen::Isometry3d& T_old_new) {
  const Eigen::Isometry3f T_new_old = T_old_new.inverse().cast<float>();
  for (LidarPoint& point : points) positionOf(point) = (T_new_old * positionOf(point)).eval();
}

void makeZeros(std::vector<LidarPoint>& points) { std::fill(points.begin(), points.end(), LidarPoint()); }

void makeOnePoint(std::vector<LidarPoint>& points) {
  if (!points.empty()) std::fill(points.begin(), points.end(), LidarPoint(points[points.size() / 2]));
}

void makeFewPoints(std::vector<LidarPoint>& points) {
  constexpr std::size_t kPoints = 200;
  const std::size_t step = std::max<std::size_t>(1, points.size() / kPoints);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i % step != 0) points[i] = LidarPoint();
  }
}

void makeEmpty(std::vector<LidarPoint>& points) { points.clear(); }

void makeNotANumber(std::vector<LidarPoint>& points) {
  for (LidarPoint& point : points) positionOf(point).setConstant(std::numeric_limits<float>::quiet_NaN());
}

}  // namespace saw_ndt
