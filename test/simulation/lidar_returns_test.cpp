// What a LiDAR makes of the surfaces that it meets: losses, noise, brightness, mixed returns and rain.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "simple_scene.h"
#include "simulation/lidar_simulator.h"

namespace saw_ndt {
namespace {

LidarScan firstScan(const Scene& scene, const LidarOptions& options) {
  return LidarSimulator(scene, options).scan(straightDrive(1, 0.0), 0);
}

TEST(LidarReturns, TheShareLostGrowsWithRangeAndIncidenceAsTheLightDoes) {
  LidarOptions options = perfectLidar();
  options.detection_range_m = 70.0;
  options.power_fluctuation = 0.3;
  options.surface_roughness_rad = 0.0;  // received: reflectivity cos(incidence) / range^2
  options.max_range_m = 120.0;
  const LidarScan scan = firstScan(sceneOf({ground()}, {{40, 0.3F}}), options);
  int partly_seen = 0;
  double share_above = 0.0;
  for (int ring = 8; ring < 64; ++ring) {
    const double cosine = std::sin(radiansFromDegrees(-options.sensor.elevations_deg[ring]));
    const double range_m = kSensorHeight_m / cosine;
    const double margin = 0.3 * cosine / (range_m * range_m) / (0.1 / (70.0 * 70.0));
    const double expected = 0.5 * std::erfc(-std::log(margin) / 0.3 / std::sqrt(2.0));
    const double share = static_cast<double>(std::count(scan.rings.begin(), scan.rings.end(), ring)) / 2083.0;
    // Five standard errors of a share of 2083.
    EXPECT_NEAR(share, expected, 5.0 * std::sqrt(expected * (1.0 - expected) / 2083.0) + 1e-9) << ring;
    EXPECT_GE(share, share_above - 1e-9);
    share_above = expected - 5.0 * std::sqrt(expected * (1.0 - expected) / 2083.0);
    partly_seen += share > 0.02 && share < 0.98 ? 1 : 0;
  }
  EXPECT_GE(partly_seen, 2);
  EXPECT_EQ(share_above, 1.0);
}

TEST(LidarReturns, RoughSurfacesAreSeenFartherAslant) {
  LidarOptions options = perfectLidar();
  options.detection_range_m = 70.0;
  const Scene scene = sceneOf({ground()}, {{40, 0.2F}});
  const std::size_t rough = firstScan(scene, options).points.size();
  options.surface_roughness_rad = 0.0;
  EXPECT_GT(10 * rough, 11 * firstScan(scene, options).points.size());
}

TEST(LidarReturns, RangesErrByBeamAndByReturn) {
  LidarOptions options = perfectLidar();
  options.range_noise_m = 0.02;
  options.beam_range_offset_m = 0.01;
  const Scene scene = sceneOf({sphere(20.0F, 500)});
  const VehicleMotion motion = {{0.0}, {Eigen::Isometry3d::Identity()}};
  const auto beamMeans = [&](std::uint64_t seed, double* variance) {
    options.seed = seed;
    const LidarScan scan = LidarSimulator(scene, options).scan(motion, 0);
    std::vector<double> means(64, 0.0);
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      means[scan.rings[i]] += (positionOf(scan.points[i]).norm() - 20.0) / 2083.0;
    }
    *variance = 0.0;
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      const double error = positionOf(scan.points[i]).norm() - 20.0 - means[scan.rings[i]];
      *variance += error * error / static_cast<double>(scan.points.size());
    }
    return means;
  };
  double variance = 0.0, other_variance = 0.0;
  const std::vector<double> means = beamMeans(1, &variance), others = beamMeans(2, &other_variance);
  // 130,000 returns: the standard error of their deviation is 0.2 %.
  EXPECT_NEAR(std::sqrt(variance), 0.02, 0.0004);
  double squares = 0.0;
  for (std::size_t beam = 0; beam < means.size(); ++beam) {
    EXPECT_NEAR(means[beam], others[beam], 5.0 * 0.02 * std::sqrt(2.0 / 2083.0));
    squares += means[beam] * means[beam] / 64.0;
  }
  EXPECT_NEAR(std::sqrt(squares), 0.01, 0.004);
}

TEST(LidarReturns, RetroReflectorsSaturateAndBlackIsLostFirst) {
  LidarOptions options;
  options.own_vehicle.setEmpty();
  const Scene scene =
      sceneOf({rectangle({30, -5, 0}, {0, 10, 0}, {0, 0, 4}, 0), rectangle({-30, -5, 0}, {0, 10, 0}, {0, 0, 4}, 1),
               rectangle({-5, 30, 0}, {10, 0, 0}, {0, 0, 4}, 2)},
              {{81, 20.0F}, {10, 0.01F}, {50, 0.4F}});
  const LidarScan scan = firstScan(scene, options);
  int counts[3] = {};
  int saturated = 0;
  double wall_reflectance = 0.0;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const float reflectance = scan.points[i].intensity;
    EXPECT_GE(reflectance, 0.0F);
    EXPECT_LE(reflectance, 0.99F);
    const std::uint16_t semantic_class = scan.semantic_classes[i];
    ++counts[semantic_class == 81 ? 0 : semantic_class == 10 ? 1 : 2];
    if (semantic_class == 50) wall_reflectance += reflectance;
    if (semantic_class == 81 && reflectance == 0.99F) ++saturated;
  }
  EXPECT_GT(counts[0], 1000);
  EXPECT_GT(saturated, 0.99 * counts[0]);  // less where the beam's edge alone touches it
  EXPECT_LT(counts[1], counts[0] / 4);
  EXPECT_GT(counts[2], 1000);
  EXPECT_NEAR(wall_reflectance / counts[2], 0.4, 0.03);
}

/// A small wall 10 m ahead before one without an end at `far_m`.
Scene twoWalls(float far_m) {
  return sceneOf({rectangle({10, -1, 1}, {0, 2, 0}, {0, 0, 1.2F}, 0),
                  rectangle({far_m, -500, -500}, {0, 1000, 0}, {0, 0, 1000}, 1)},
                 {{50, 0.4F}, {51, 0.4F}});
}

/// The points less than 30 degrees off the x axis.
std::vector<LidarPoint> pointsAhead(const LidarScan& scan) {
  std::vector<LidarPoint> points;
  for (const LidarPoint& point : scan.points) {
    if (point.x > std::sqrt(3.0F) * std::abs(point.y)) points.push_back(point);
  }
  return points;
}

TEST(LidarReturns, AtEdgesTwoNearSurfacesGiveOneReturnBetweenThem) {
  LidarOptions options = perfectLidar();
  options.beam_divergence_rad = 2e-3;
  int mixed = 0;
  for (const LidarPoint& point : pointsAhead(firstScan(twoWalls(10.5F), options))) {
    EXPECT_GT(point.x, 9.9999F);
    EXPECT_LT(point.x, 10.5001F);
    if (point.x < 10.001F || point.x > 10.499F) continue;
    ++mixed;
    // No farther from an edge of the small wall, as seen from the LiDAR, than half the footprint and a firing or ring.
    const double left = std::atan2(1.0, 10.0), azimuth = std::abs(std::atan2(point.y, point.x));
    const double rise = std::atan2(point.z, std::hypot(point.x, point.y));
    const double top = std::atan2(2.2 - kSensorHeight_m, 10.0), bottom = std::atan2(1.0 - kSensorHeight_m, 10.0);
    const double off_edge = std::min({std::abs(azimuth - left), std::abs(rise - top), std::abs(rise - bottom)});
    EXPECT_LT(off_edge, radiansFromDegrees(0.5));
  }
  EXPECT_GT(mixed, 10);
  EXPECT_LT(mixed, 120);
}

TEST(LidarReturns, AtEdgesOfFarSurfacesAReturnIsOfOneOfThem) {
  LidarOptions options = perfectLidar();
  options.beam_divergence_rad = 2e-3;
  for (const LidarPoint& point : pointsAhead(firstScan(twoWalls(12.0F), options))) {
    // Off the ray of its own surface by up to a firing, a point keeps the range of the other one.
    EXPECT_TRUE(std::abs(point.x - 10.0F) < 0.02F || std::abs(point.x - 12.0F) < 0.02F) << point.x;
  }
}

TEST(LidarReturns, NothingIsMixedWithoutEdges) {
  LidarOptions options = perfectLidar();
  options.beam_divergence_rad = 5e-3;
  const LidarScan scan = firstScan(sceneOf({ground()}), options);
  for (const LidarPoint& point : scan.points) {
    // The farthest ring has the sky beside it, but no surface to mix with.
    if (positionOf(point).norm() > 60.0F) continue;
    EXPECT_NEAR(point.z, -kSensorHeight_m, 1e-4);
  }
}

TEST(LidarReturns, RainGivesNearOutliers) {
  LidarOptions options = perfectLidar();
  options.rain_share = 0.05;
  options.rain_mean_range_m = 4.0;
  const LidarScan scan = firstScan(sceneOf({sphere(30.0F, 100)}), options);
  double drops = 0.0;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    if (scan.semantic_classes[i] != 1) continue;
    drops += 1.0;
    EXPECT_LE(scan.points[i].intensity, 0.05F);
    EXPECT_GE(positionOf(scan.points[i]).norm(), 0.999F);
  }
  // Those nearer than min_range_m are lost. Five standard errors of a share.
  const double firings = 64.0 * 2083.0, expected = 0.05 * std::exp(-1.0 / 4.0);
  EXPECT_NEAR(drops / firings, expected, 5.0 * std::sqrt(expected / firings));
}

}  // namespace
}  // namespace saw_ndt
