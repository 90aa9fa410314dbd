#pragma once

#include <Eigen/Geometry>
#include <boost/container_hash/hash.hpp>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "simulation/scene_description.h"

namespace saw_ndt {

/// A place on the way.
struct RouteStation {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();    ///< on the ground, scene frame (m)
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();  ///< of the way, level, unit length
  double slope = 0.0;                                    ///< rise of the way a metre

  /// The level unit vector to the left.
  Eigen::Vector2d left() const { return {-direction.y(), direction.x()}; }
};

/// The way of a vehicle over the ground, as stations one metre apart.
class Route {
 public:
  static constexpr double kStationSpacing_m = 1.0;

  /// The way that a scene's course describes; hills are drawn by the seed. @throws std::invalid_argument where the
  /// scene has no course
  static Route fromCourse(const SceneDescription& scene, std::uint64_t seed);

  /// The way through the given ground points. @throws std::invalid_argument where it is shorter than two metres, or a
  /// position is not finite or farther than 100 km from the first
  static Route throughPositions(const std::vector<Eigen::Vector3d>& positions);

  const std::vector<RouteStation>& stations() const { return stations_; }
  double length_m() const { return static_cast<double>(stations_.size() - 1) * kStationSpacing_m; }

  /// The place at a distance along the way (m), interpolated; before the start and after the end in a straight line.
  RouteStation at(double distance_m) const;

  /// The numbers of the stations within a distance (m) of a point, in order.
  std::vector<std::uint32_t> stationsNear(const Eigen::Vector2d& point, double distance_m) const;

 private:
  using Bucket = std::pair<int, int>;

  explicit Route(std::vector<RouteStation> stations);
  static Bucket bucketOf(const Eigen::Vector2d& point);

  std::vector<RouteStation> stations_;
  std::unordered_map<Bucket, std::vector<std::uint32_t>, boost::hash<Bucket>> buckets_;
};

/// Distance of a point from the edge of the road (m), negative on it: the least over the stations' stretches of road,
/// each from `left_m` left to `right_m` right of the way. Infinite without stations.
double roadEdgeDistance(const Route& route, const std::vector<std::uint32_t>& stations, const RoadDescription& road,
                        const Eigen::Vector2d& point);

}  // namespace saw_ndt
