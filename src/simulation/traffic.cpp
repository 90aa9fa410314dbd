#include "simulation/traffic.h"

#include <algorithm>
#include <cmath>

#include "saw_ndt/common/geometry.h"
#include "simulation/object_meshes.h"
#include "simulation/random_numbers.h"

namespace saw_ndt {
namespace {

constexpr int kVariants = 6;
/// Where what is not to be seen is kept.
const Eigen::Vector3d kOutOfSight(0.0, 0.0, -10000.0);
/// An object drives on this far beyond the ends of the way, where there is still ground near the way.
constexpr double kOverrun_m = 30.0;

/// Where things that move along a route are.
struct Traveller {
  std::shared_ptr<const Route> route;
  std::shared_ptr<const Terrain> terrain;
  std::shared_ptr<const VehicleMotion> motion;
  double lateral_m = 0.0;
  double half_length_m = 0.0;
  double start_m = 0.0, speed_mps = 0.0;  ///< along the way, at the first stamp
  double headway_s = 0.0;                 ///< not 0: follows the vehicle's own motion

  Eigen::Isometry3d at(double stamp_s) const {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    Eigen::Vector2d position, direction;
    if (headway_s != 0.0) {
      const double own_s = std::clamp(stamp_s + headway_s, motion->stamps_s.front(), motion->stamps_s.back());
      const Eigen::Isometry3d T_scene_lidar = motion->poseAt(own_s);
      direction = T_scene_lidar.linear().col(0).head<2>().normalized();
      position = T_scene_lidar.translation().head<2>();
    } else {
      const double along_m = start_m + speed_mps * (stamp_s - motion->stamps_s.front());
      if (along_m < -kOverrun_m || along_m > route->length_m() + kOverrun_m) {
        T.translation() = kOutOfSight;
        return T;
      }
      const RouteStation station = route->at(along_m);
      direction = speed_mps < 0.0 ? Eigen::Vector2d(-station.direction) : station.direction;
      position = station.position.head<2>() + lateral_m * station.left();
    }
    const Eigen::Vector2d from_vehicle = position - motion->poseAt(stamp_s).translation().head<2>();
    if (from_vehicle.norm() < half_length_m + 2.0) {  // it would stand on the vehicle itself
      T.translation() = kOutOfSight;
      return T;
    }
    T.translation() << position, terrain->height(position);
    T.linear() = Eigen::AngleAxisd(std::atan2(direction.y(), direction.x()), Eigen::Vector3d::UnitZ()).matrix();
    return T;
  }
};

}  // namespace

void addTraffic(const SceneDescription& description, const std::shared_ptr<const Route>& route,
                const std::shared_ptr<const Terrain>& terrain, const std::shared_ptr<const VehicleMotion>& motion,
                const DriveOptions& options, Scene& scene) {
  const double duration_s = motion->stamps_s.back() - motion->stamps_s.front();
  for (std::size_t number = 0; number < description.traffic.size(); ++number) {
    const TrafficStream& stream = description.traffic[number];
    SceneRandom random(mixedSeed(options.seed, options.drive, 1000 + number));
    std::vector<std::pair<std::uint32_t, double>> variants;  // mesh, length
    for (int i = 0; i < kVariants; ++i) {
      const ObjectSize size{random.uniform(stream.length_m), random.uniform(stream.width_m),
                            random.uniform(stream.height_m)};
      variants.emplace_back(static_cast<std::uint32_t>(scene.meshes.size()), size.length_m);
      scene.meshes.push_back(makeObjectMesh(stream.object, size, true, mixedSeed(random.index(1u << 30))));
    }
    const auto add = [&](const Traveller& traveller, std::size_t variant) {
      scene.moving_objects.push_back(
          {variants[variant].first, [traveller](double stamp_s) { return traveller.at(stamp_s); }});
    };
    Traveller traveller{route, terrain, motion};
    const bool follows = stream.headway_s.min != 0.0 || stream.headway_s.max != 0.0;
    // As many as pass while the vehicle is under way.
    const double fastest_mps = std::max(std::abs(stream.speed_mps.min), std::abs(stream.speed_mps.max));
    const double passed_m = fastest_mps * duration_s;
    const double count =
        options.traffic_density * (follows ? 1.0 : stream.per_km * (route->length_m() + passed_m) / 1e3);
    for (double i = random.uniform(0.0, 1.0); i < count; i += 1.0) {
      const std::size_t variant = random.index(variants.size());
      traveller.lateral_m = random.uniform(stream.lateral_m);
      traveller.half_length_m = variants[variant].second / 2.0;
      traveller.speed_mps = random.uniform(stream.speed_mps);
      traveller.headway_s = follows ? random.uniform(stream.headway_s) : 0.0;
      traveller.start_m = traveller.speed_mps < 0.0 ? random.uniform(0.0, route->length_m() + passed_m)
                                                    : random.uniform(-passed_m, route->length_m());
      add(traveller, variant);
    }
  }
}

}  // namespace saw_ndt
