#include "simulation/route.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"
#include "simulation/lattice_noise.h"

namespace saw_ndt {
namespace {

constexpr double kBucket_m = 32.0;
constexpr double kLongestExtent_m = 1e5;

/// Directions and slopes of stations whose positions are set, from the neighbours two stations away on either side.
void setDirections(std::vector<RouteStation>& stations) {
  constexpr std::size_t kReach = 2;
  for (std::size_t i = 0; i < stations.size(); ++i) {
    const Eigen::Vector3d& before = stations[i < kReach ? 0 : i - kReach].position;
    const Eigen::Vector3d& after = stations[std::min(i + kReach, stations.size() - 1)].position;
    const Eigen::Vector3d step = after - before;
    const double level_m = step.head<2>().norm();
    if (level_m > 1e-6) {
      stations[i].direction = step.head<2>() / level_m;
      stations[i].slope = step.z() / level_m;
    } else if (i > 0) {
      stations[i].direction = stations[i - 1].direction;
    }
  }
}

}  // namespace

Route::Route(std::vector<RouteStation> stations) : stations_(std::move(stations)) {
  setDirections(stations_);
  for (std::uint32_t i = 0; i < stations_.size(); ++i) {
    buckets_[bucketOf(stations_[i].position.head<2>())].push_back(i);
  }
}

Route::Bucket Route::bucketOf(const Eigen::Vector2d& point) {
  return {static_cast<int>(std::floor(point.x() / kBucket_m)), static_cast<int>(std::floor(point.y() / kBucket_m))};
}

Route Route::fromCourse(const SceneDescription& scene, std::uint64_t seed) {
  checkOption(!scene.course.empty(), "course", "[]", "stated where no trajectory is given");
  const LatticeNoise hills(seed, scene.terrain.hill_length_m / 2.0);
  std::vector<RouteStation> stations;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  double direction = 0.0;
  for (const CourseElement& element : scene.course) {
    const auto steps = std::max(1L, std::lround(element.length_m / kStationSpacing_m));
    const double turn = radiansFromDegrees(element.turn_deg) / static_cast<double>(steps);
    for (long step = 0; step < steps; ++step) {
      RouteStation& station = stations.emplace_back();
      station.position << position, scene.terrain.hill_height_m * hills(position);
      direction += turn / 2.0;
      position += kStationSpacing_m * Eigen::Vector2d(std::cos(direction), std::sin(direction));
      direction += turn / 2.0;
    }
  }
  checkOption(stations.size() >= 2, "course", stations.size(), "longer than two metres");
  return Route(std::move(stations));
}

Route Route::throughPositions(const std::vector<Eigen::Vector3d>& positions) {
  std::vector<RouteStation> stations;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const bool usable = positions[i].allFinite() && (positions[i] - positions[0]).norm() <= kLongestExtent_m;
    checkOption(usable, "position", positions[i].transpose(), "finite and within 100 km of the first");
    if (stations.empty()) stations.emplace_back().position = positions[i];
    while (true) {
      const Eigen::Vector3d step = positions[i] - stations.back().position;
      const double level_m = step.head<2>().norm();
      if (level_m < kStationSpacing_m) break;
      const Eigen::Vector3d next = stations.back().position + step * (kStationSpacing_m / level_m);
      stations.emplace_back().position = next;
    }
  }
  checkOption(stations.size() >= 3, "trajectory length in metres", stations.size(), "at least 2");
  return Route(std::move(stations));
}

RouteStation Route::at(double distance_m) const {
  const double index = std::clamp(distance_m / kStationSpacing_m, 0.0, static_cast<double>(stations_.size() - 1));
  const std::size_t i = std::min(static_cast<std::size_t>(index), stations_.size() - 2);
  const double share = index - static_cast<double>(i);
  RouteStation station;
  station.position = (1.0 - share) * stations_[i].position + share * stations_[i + 1].position;
  station.direction = ((1.0 - share) * stations_[i].direction + share * stations_[i + 1].direction).normalized();
  station.slope = (1.0 - share) * stations_[i].slope + share * stations_[i + 1].slope;
  const double beyond_m = distance_m - index * kStationSpacing_m;
  station.position.head<2>() += beyond_m * station.direction;
  station.position.z() += beyond_m * station.slope;
  return station;
}

std::vector<std::uint32_t> Route::stationsNear(const Eigen::Vector2d& point, double distance_m) const {
  const Bucket low = bucketOf(point - Eigen::Vector2d::Constant(distance_m));
  const Bucket high = bucketOf(point + Eigen::Vector2d::Constant(distance_m));
  std::vector<std::uint32_t> result;
  for (int x = low.first; x <= high.first; ++x) {
    for (int y = low.second; y <= high.second; ++y) {
      const auto bucket = buckets_.find({x, y});
      if (bucket == buckets_.end()) continue;
      for (const std::uint32_t i : bucket->second) {
        if ((stations_[i].position.head<2>() - point).norm() <= distance_m) result.push_back(i);
      }
    }
  }
  std::sort(result.begin(), result.end());
  return result;
}

double roadEdgeDistance(const Route& route, const std::vector<std::uint32_t>& stations, const RoadDescription& road,
                        const Eigen::Vector2d& point) {
  // The stretch of a station reaches half way to its neighbours, and a little farther so that bends leave no gaps.
  constexpr double kHalfLength_m = 0.6 * Route::kStationSpacing_m;
  const double centre_m = (road.left_m - road.right_m) / 2.0, half_width_m = (road.left_m + road.right_m) / 2.0;
  double least_m = std::numeric_limits<double>::infinity();
  for (const std::uint32_t i : stations) {
    const RouteStation& station = route.stations()[i];
    const Eigen::Vector2d offset = point - station.position.head<2>();
    const double along_m = std::max(0.0, std::abs(offset.dot(station.direction)) - kHalfLength_m);
    const double across_m = std::abs(offset.dot(station.left()) - centre_m) - half_width_m;
    const double distance_m = along_m == 0.0 ? across_m : std::hypot(along_m, std::max(0.0, across_m));
    least_m = std::min(least_m, distance_m);
  }
  return least_m;
}

}  // namespace saw_ndt
