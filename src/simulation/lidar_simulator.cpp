#include "simulation/lidar_simulator.h"

#include <algorithm>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_01.hpp>
#include <cmath>
#include <stdexcept>
#include <string>

#include "common/executor.h"
#include "saw_ndt/common/geometry.h"
#include "simulation/beam_constants.h"
#include "simulation/random_engine.h"
#include "simulation/ray_caster.h"
#include "simulation/return_model.h"

namespace saw_ndt {

using namespace internal;

namespace {

// The LiDAR's pose during a scan is read off at this many moments; in between, straight lines miss it by less than a
// micrometre.
constexpr std::size_t kPoseKnots = 257;

// How far from azimuth 0 rays stay, so that no rounding puts the last one of a ring before the first.
constexpr double kSeam_rad = 1e-5;

// What a random engine is for.
enum RandomUse : std::uint64_t { kPhase, kJitter, kReturns };

/// Poses of the LiDAR during a scan, evenly spaced in time; one where it stands still.
struct PoseKnots {
  std::vector<Eigen::Matrix3f> R_scene_lidar;
  std::vector<Eigen::Vector3f> positions;

  void add(const Eigen::Isometry3d& T_scene_lidar) {
    R_scene_lidar.push_back(T_scene_lidar.linear().cast<float>());
    positions.push_back(T_scene_lidar.translation().cast<float>());
  }

  /// Turns a direction into the scene's frame and adds the origin.
  Ray ray(const Eigen::Vector3f& direction, float time_share) const {
    if (positions.size() == 1) return {positions[0], R_scene_lidar[0] * direction, time_share};
    const float place = time_share * static_cast<float>(positions.size() - 1);
    const std::size_t knot = std::min(static_cast<std::size_t>(place), positions.size() - 2);
    const float share = place - static_cast<float>(knot);
    const Eigen::Vector3f before = R_scene_lidar[knot] * direction, after = R_scene_lidar[knot + 1] * direction;
    return {positions[knot] + share * (positions[knot + 1] - positions[knot]), before + share * (after - before),
            time_share};
  }
};

/// Range (m) at which a ray from the LiDAR enters the box; infinite where it does not.
float rangeOfBox(const Eigen::AlignedBox3f& box, const Eigen::Vector3f& direction) {
  const Eigen::Array3f a = box.min().array() / direction.array(), b = box.max().array() / direction.array();
  const float enter = a.min(b).maxCoeff(), leave = a.max(b).minCoeff();
  return enter > 0.0F && enter <= leave ? enter : std::numeric_limits<float>::infinity();
}

}  // namespace

class LidarSimulator::Parts {
 public:
  Parts(const Scene& scene, const LidarOptions& options, int threads);

  LidarScan scan(const VehicleMotion& motion, int scan);

  LidarOptions options;

 private:
  PoseKnots posesDuring(const VehicleMotion& motion, int scan) const;
  void fireRing(const PoseKnots& poses, int scan, int ring, double phase);

  int threads_;
  RayCaster caster_;
  ReturnModel model_;
  BeamConstants beams_;
  Eigen::Matrix3f R_vehicle_lidar_;
  std::vector<Eigen::Vector2d> firing_directions_;  ///< cosine and sine of the azimuth of each firing
  std::vector<RingHits> rings_;
  std::vector<RingReturns> returns_;
};

LidarSimulator::Parts::Parts(const Scene& scene, const LidarOptions& lidar_options, int threads)
    : options((lidar_options.check(), lidar_options)),
      threads_(internal::threadCount(threads)),
      caster_(scene),
      model_(options, scene.materials),
      beams_(beamConstants(options)),
      R_vehicle_lidar_(options.R_vehicle_lidar().cast<float>()),
      rings_(static_cast<std::size_t>(options.sensor.rows())),
      returns_(rings_.size()) {
  for (int firing = 0; firing < options.firings_per_turn; ++firing) {
    const double azimuth = 2.0 * kPi * firing / options.firings_per_turn;
    firing_directions_.emplace_back(std::cos(azimuth), std::sin(azimuth));
  }
}

PoseKnots LidarSimulator::Parts::posesDuring(const VehicleMotion& motion, int scan) const {
  PoseKnots poses;
  if (!options.rolling_shutter) {
    poses.add(motion.T_scene_lidar[scan]);
    return poses;
  }
  for (std::size_t knot = 0; knot < kPoseKnots; ++knot) {
    const double share = static_cast<double>(knot) / (kPoseKnots - 1) - 0.5;
    poses.add(motion.poseAt(motion.stamps_s[scan] + share * options.scan_period_s));
  }
  return poses;
}

void LidarSimulator::Parts::fireRing(const PoseKnots& poses, int scan, int ring, double phase) {
  RandomEngine random =
      seededEngine({options.seed, static_cast<std::uint64_t>(scan), static_cast<std::uint64_t>(ring), kJitter});
  boost::random::normal_distribution<float> normal;
  const std::size_t firings = firing_directions_.size();
  const double step_rad = 2.0 * kPi / static_cast<double>(firings);
  const auto jitter_rad = static_cast<float>(options.angle_jitter_rad);
  const auto most_jitter_rad = static_cast<float>(0.49 * step_rad);  // no ray passes its neighbour: azimuths rise
  RingHits& own = rings_[ring];
  own.directions.resize(firings);
  own.hits.resize(firings);
  thread_local std::vector<Ray> rays;  // memory kept between rings
  rays.resize(firings);
  own.firing_offset = std::fmod(beams_.firing_offsets[ring] + phase, 1.0);
  const double offset_rad = own.firing_offset * step_rad;
  const double elevation_rad = radiansFromDegrees(options.sensor.elevations_deg[ring]);
  const auto cos_elevation = static_cast<float>(std::cos(elevation_rad));
  const auto sin_elevation = static_cast<float>(std::sin(elevation_rad));

  for (std::size_t firing = 0; firing < firings; ++firing) {
    const double even_rad = static_cast<double>(firing) * step_rad + offset_rad;
    double azimuth_rad = even_rad;
    float rise_rad = 0.0F;
    if (jitter_rad > 0.0F) {
      azimuth_rad += std::clamp(jitter_rad * normal(random), -most_jitter_rad, most_jitter_rad);
      rise_rad = jitter_rad * normal(random);
    }
    azimuth_rad = std::clamp(azimuth_rad, kSeam_rad, 2.0 * kPi - kSeam_rad);
    // From the firing's table entry: less than one and a half steps, for which the series is exact to float.
    const double turn_rad = azimuth_rad - static_cast<double>(firing) * step_rad;
    const double squared = turn_rad * turn_rad;
    const double cosine = 1.0 - squared * (0.5 - squared * (1.0 / 24.0 - squared / 720.0));
    const double sine = turn_rad * (1.0 - squared * (1.0 / 6.0 - squared * (1.0 / 120.0 - squared / 5040.0)));
    const Eigen::Vector2d& base = firing_directions_[firing];
    const float horizontal = cos_elevation - rise_rad * sin_elevation;
    own.directions[firing] = {horizontal * static_cast<float>(base.x() * cosine - base.y() * sine),
                              horizontal * static_cast<float>(base.y() * cosine + base.x() * sine),
                              sin_elevation + rise_rad * cos_elevation};
    const double time_share = azimuth_rad / (2.0 * kPi) + (azimuth_rad <= kPi ? 0.5 : -0.5);
    rays[firing] = poses.ray(own.directions[firing], static_cast<float>(time_share));
  }
  caster_.cast(rays.data(), firings, static_cast<float>(options.max_range_m), own.hits.data());

  // Normals in the LiDAR's frame, of which one pose a scan is close enough.
  const Eigen::Matrix3f R_lidar_scene = poses.R_scene_lidar[poses.R_scene_lidar.size() / 2].transpose();
  const bool hidden = !options.own_vehicle.isEmpty();
  for (std::size_t firing = 0; firing < firings; ++firing) {
    RayHit& hit = own.hits[firing];
    if (hit.isHit()) hit.normal = R_lidar_scene * hit.normal;
    if (!hidden) continue;
    const float range_m = rangeOfBox(options.own_vehicle, R_vehicle_lidar_ * own.directions[firing]);
    if (range_m < hit.range_m) hit = {range_m, -own.directions[firing], model_.ownVehicleMaterial()};
  }
}

LidarScan LidarSimulator::Parts::scan(const VehicleMotion& motion, int scan) {
  if (scan < 0 || scan >= motion.scanCount()) {
    throw std::out_of_range("scan " + std::to_string(scan) + ": the motion has " + std::to_string(motion.scanCount()));
  }
  if (motion.T_scene_lidar.size() != motion.stamps_s.size()) {
    throw std::invalid_argument("T_scene_lidar.size() = " + std::to_string(motion.T_scene_lidar.size()) +
                                ": must be that of stamps_s, " + std::to_string(motion.stamps_s.size()));
  }
  const double stamp_s = motion.stamps_s[scan];
  if (!std::isfinite(stamp_s) || !motion.T_scene_lidar[scan].affine().allFinite()) {
    throw std::invalid_argument("stamp and pose of scan " + std::to_string(scan) + ": must be finite");
  }

  const PoseKnots poses = posesDuring(motion, scan);
  caster_.setTimeSpan(stamp_s - 0.5 * options.scan_period_s, stamp_s + 0.5 * options.scan_period_s);
  RandomEngine random = seededEngine({options.seed, static_cast<std::uint64_t>(scan), 0, kPhase});
  const double phase = boost::random::uniform_01<double>()(random);
  const int rings = options.sensor.rows();
  const auto ring_count = static_cast<std::size_t>(rings);
  internal::forEachChunkOffline(threads_, ring_count,
                                [&](std::size_t ring, int) { fireRing(poses, scan, static_cast<int>(ring), phase); });
  internal::forEachChunkOffline(threads_, ring_count, [&](std::size_t ring, int) {
    RandomEngine ring_random = seededEngine({options.seed, static_cast<std::uint64_t>(scan), ring, kReturns});
    model_.measure(rings_, static_cast<int>(ring), ring_random, &returns_[ring]);
  });

  std::size_t point_count = 0;
  for (const RingReturns& returns : returns_) point_count += returns.points.size();
  LidarScan result;
  result.points.reserve(point_count);
  result.semantic_classes.reserve(point_count);
  result.rings.reserve(point_count);
  for (std::size_t ring = 0; ring < returns_.size(); ++ring) {
    const RingReturns& returns = returns_[ring];
    result.points.insert(result.points.end(), returns.points.begin(), returns.points.end());
    result.semantic_classes.insert(result.semantic_classes.end(), returns.semantic_classes.begin(),
                                   returns.semantic_classes.end());
    result.rings.resize(result.points.size(), static_cast<std::uint16_t>(ring));
  }
  return result;
}

LidarSimulator::LidarSimulator(const Scene& scene, const LidarOptions& options, int threads)
    : parts_(std::make_unique<Parts>(scene, options, threads)) {}
LidarSimulator::~LidarSimulator() = default;

const LidarOptions& LidarSimulator::options() const { return parts_->options; }

LidarScan LidarSimulator::scan(const VehicleMotion& motion, int scan) { return parts_->scan(motion, scan); }

}  // namespace saw_ndt
