#include "simulation/lidar_simulator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "expect_throws.h"
#include "saw_ndt/pcl/cloud_view.h"
#include "segmentation/range_image.h"
#include "simple_scene.h"

namespace saw_ndt {

using namespace internal;

namespace {

double azimuthOf(const LidarPoint& point) {
  const double azimuth = std::atan2(static_cast<double>(point.y), static_cast<double>(point.x));
  return azimuth < 0.0 ? azimuth + 2.0 * kPi : azimuth;
}

double firingTime(const LidarOptions& options, double stamp_s, const LidarPoint& point) {
  return stamp_s + options.scan_period_s * wrappedAngle(azimuthOf(point)) / (2.0 * kPi);
}

bool equal(const LidarScan& a, const LidarScan& b) {
  if (a.points.size() != b.points.size() || a.semantic_classes != b.semantic_classes || a.rings != b.rings) {
    return false;
  }
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    if (positionOf(a.points[i]) != positionOf(b.points[i])) return false;
    if (a.points[i].intensity != b.points[i].intensity) return false;
  }
  return true;
}

// Walls, a pole and a block on the ground: steps in range all around.
Scene crossing() {
  Scene scene = sceneOf({ground(), rectangle({-60, 12, 0}, {120, 0, 0}, {0, 0, 8}, 1), sphere(1.5F, 40, 1),
                         block({2.2F, 0.9F, 0.75F}, 2)},
                        {{40, 0.3F}, {50, 0.4F}, {10, 0.1F}});
  scene.objects[2].T_scene_object = Eigen::Translation3f(9, 3, 1);
  scene.objects[3].T_scene_object = Eigen::Translation3f(-7, -4, 0.9F);
  scene.objects.push_back({3, Eigen::Affine3f(Eigen::Translation3f(12, -4, 0.9F))});
  return scene;
}

TEST(LidarSimulator, APlaneIsMetAtHeightOverSineOfElevation) {
  LidarSimulator simulator(sceneOf({ground()}), perfectLidar());
  const LidarScan scan = simulator.scan(straightDrive(1, 0.0), 0);
  std::vector<int> counts(64, 0);
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const double sine = std::sin(radiansFromDegrees(-simulator.options().sensor.elevations_deg[scan.rings[i]]));
    // At 1e-7 of a float's digits over the grazing angle.
    const double range_m = kSensorHeight_m / sine;
    EXPECT_NEAR(positionOf(scan.points[i]).norm(), range_m, range_m > 40.0 ? 1e-3 : 1e-4);
    EXPECT_EQ(scan.semantic_classes[i], 40);
    ++counts[scan.rings[i]];
  }
  for (int ring = 0; ring < 64; ++ring) {
    const double sine = std::sin(radiansFromDegrees(-simulator.options().sensor.elevations_deg[ring]));
    EXPECT_EQ(counts[ring], sine > 0.0 && kSensorHeight_m / sine < 80.0 ? 2083 : 0) << ring;
  }
}

TEST(LidarSimulator, PointsOfAWallAndASphereLieOnThem) {
  LidarSimulator simulator(crossing(), perfectLidar());
  const LidarScan scan = simulator.scan(straightDrive(1, 0.0), 0);
  int on_wall = 0, on_sphere = 0;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    if (scan.semantic_classes[i] != 50) continue;
    const Eigen::Vector3f point =
        positionOf(scan.points[i]) + Eigen::Vector3f(0, 0, static_cast<float>(kSensorHeight_m));
    const float from_centre = (point - Eigen::Vector3f(9, 3, 1)).norm();
    if (from_centre < 2.0F) {
      // Chords of 40 facets a half turn are up to 1.5 (1 - cos(pi / 80)) inside, on both axes.
      EXPECT_NEAR(from_centre, 1.4988, 0.0013);
      ++on_sphere;
    } else {
      EXPECT_NEAR(point.y(), 12.0F, 1e-4F);
      ++on_wall;
    }
  }
  EXPECT_GT(on_sphere, 300);
  EXPECT_GT(on_wall, 3000);
}

TEST(LidarSimulator, RingsAreRecoveredFromTheOrderOfPoints) {
  for (const char* name : {"HDL-64E", "VLP-16", "OS-128"}) {
    // Rings are told by azimuths that fall by more than half a turn: each has to see something all around.
    Scene scene = crossing();
    scene.objects.push_back({2, Eigen::Affine3f(Eigen::Scaling(30.0F))});
    LidarSimulator simulator(scene, LidarOptions::named(name));
    const LidarScan scan = simulator.scan(straightDrive(1, 0.0), 0);
    for (std::size_t i = 1; i < scan.points.size(); ++i) {
      if (scan.rings[i] == scan.rings[i - 1]) {
        EXPECT_GT(azimuthOf(scan.points[i]), azimuthOf(scan.points[i - 1]));
      } else {
        EXPECT_GT(scan.rings[i], scan.rings[i - 1]);
      }
    }
    const SensorModel& sensor = simulator.options().sensor;
    RangeImage image;
    image.project(viewOf(scan.points), sensor);
    EXPECT_EQ(image.verticalIndexSource(), VerticalIndexSource::FILE_ORDER) << name;
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      ASSERT_EQ(image.pixelOfPoint()[i] / sensor.columns, scan.rings[i]) << name << " point " << i;
    }
  }
}

TEST(LidarSimulator, BytesDependOnTheSeedAndNotOnThreads) {
  LidarOptions options;
  options.rain_share = 0.02;
  options.rolling_shutter = true;
  Scene scene = crossing();
  scene.moving_objects.push_back(
      {3, [](double stamp_s) { return Eigen::Isometry3d(Eigen::Translation3d(15.0 * stamp_s, 4, 0.9)); }});
  const VehicleMotion motion = straightDrive(3, 10.0);
  LidarSimulator one(scene, options, 1), two(scene, options, 2);
  const LidarScan first = one.scan(motion, 1);
  EXPECT_TRUE(equal(first, two.scan(motion, 1)));
  EXPECT_FALSE(equal(first, one.scan(motion, 2)));
  EXPECT_TRUE(equal(first, one.scan(motion, 1)));
  options.seed = 2;
  EXPECT_FALSE(equal(first, LidarSimulator(scene, options).scan(motion, 1)));
}

TEST(LidarSimulator, UndoingTheMotionOfARollingShutterRecoversTheWalls) {
  // A room of 60 x 60 m, driven through at 20 m/s on an arc of 0.4 rad/s.
  Scene scene =
      sceneOf({ground(), rectangle({-30, -30, 0}, {0, 60, 0}, {0, 0, 20}, 1),
               rectangle({30, -30, 0}, {0, 60, 0}, {0, 0, 20}, 2), rectangle({-30, -30, 0}, {60, 0, 0}, {0, 0, 20}, 3),
               rectangle({-30, 30, 0}, {60, 0, 0}, {0, 0, 20}, 4)},
              {{40, 0.5F}, {11, 0.5F}, {12, 0.5F}, {13, 0.5F}, {14, 0.5F}});
  VehicleMotion motion;
  for (int i = 0; i < 3; ++i) {
    const double angle = 0.04 * i;
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = rotationFromVector({0, 0, angle});
    T.translation() << 50.0 * std::sin(angle), 50.0 * (1.0 - std::cos(angle)), kSensorHeight_m;
    motion.stamps_s.push_back(10.0 + 0.1 * i);
    motion.T_scene_lidar.push_back(T);
  }
  LidarOptions options = perfectLidar();
  options.rolling_shutter = true;
  LidarSimulator simulator(scene, options);
  const LidarScan scan = simulator.scan(motion, 1);
  int counts[5] = {};
  double farthest_from_plane_m = 0.0, farthest_uncorrected_m = 0.0;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const Eigen::Vector3d point = positionOf(scan.points[i]).cast<double>();
    const auto distance = [&](const Eigen::Isometry3d& T) {
      const Eigen::Vector3d p = T * point;
      const double distances[] = {p.z(), p.x() + 30, p.x() - 30, p.y() + 30, p.y() - 30};
      return std::abs(distances[scan.semantic_classes[i] == 40 ? 0 : scan.semantic_classes[i] - 10]);
    };
    const double stamp_s = firingTime(options, motion.stamps_s[1], scan.points[i]);
    farthest_from_plane_m = std::max(farthest_from_plane_m, distance(motion.poseAt(stamp_s)));
    farthest_uncorrected_m = std::max(farthest_uncorrected_m, distance(motion.T_scene_lidar[1]));
    ++counts[scan.semantic_classes[i] == 40 ? 0 : scan.semantic_classes[i] - 10];
  }
  // Rounding of coordinates, origins and firing times to float; half a scan of driving is a metre.
  EXPECT_LT(farthest_from_plane_m, 1e-4);
  EXPECT_GT(farthest_uncorrected_m, 0.9);
  for (const int count : counts) EXPECT_GT(count, 1000);
}

TEST(LidarSimulator, WhatMovesIsSeenWhereItIsWhenFiredAt) {
  const auto T_scene_car = [](double stamp_s) {
    return Eigen::Isometry3d(Eigen::Translation3d(-12.0 + 15.0 * (stamp_s - 5.0), 4.0, 1.0));
  };
  Scene scene = sceneOf({ground()}, {{40, 0.5F}, {252, 0.5F}});
  scene.meshes.push_back(block({2, 1, 0.9F}, 1));
  scene.moving_objects.push_back({1, T_scene_car});
  VehicleMotion motion = straightDrive(2, 0.0);
  motion.stamps_s = {5.0, 5.1};
  const LidarOptions options = perfectLidar();
  LidarSimulator simulator(scene, options);
  const LidarScan scan = simulator.scan(motion, 0);
  int count = 0;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    if (scan.semantic_classes[i] != 252) continue;
    ++count;
    const Eigen::Vector3d point = motion.T_scene_lidar[0] * positionOf(scan.points[i]).cast<double>();
    const Eigen::Vector3d in_car = T_scene_car(firingTime(options, 5.0, scan.points[i])).inverse() * point;
    const Eigen::Array3d beyond = in_car.array().abs() - Eigen::Array3d(2.0, 1.0, 0.9);
    EXPECT_NEAR(beyond.maxCoeff(), 0.0, 1e-4);
  }
  EXPECT_GT(count, 500);
}

TEST(LidarSimulator, TheVehicleItselfHidesTheView) {
  LidarOptions options = perfectLidar();
  LidarSimulator free(sceneOf({ground()}), options);
  options.own_vehicle = LidarOptions().own_vehicle;
  LidarSimulator mounted(sceneOf({ground()}), options);
  const VehicleMotion motion = straightDrive(1, 0.0);
  const LidarScan all = free.scan(motion, 0), seen = mounted.scan(motion, 0);
  // As in KITTI, where about half of the lowest ring is hidden and nothing of the upper block.
  const auto countOf = [](const LidarScan& scan, int ring) {
    return static_cast<int>(std::count(scan.rings.begin(), scan.rings.end(), ring));
  };
  EXPECT_EQ(countOf(seen, 40), countOf(all, 40));
  EXPECT_LT(countOf(seen, 63), 0.7 * countOf(all, 63));
  EXPECT_GT(countOf(seen, 63), 0.4 * countOf(all, 63));
}

TEST(LidarSimulator, SeesItsFieldOfViewAlone) {
  LidarOptions options = perfectLidar();
  options.rain_share = 0.05;
  LidarSimulator all_around(crossing(), options);
  const LidarScan all = all_around.scan(straightDrive(1, 0.0), 0);
  options.field_of_view_deg = 120.0;
  LidarSimulator to_the_front(crossing(), options);
  const LidarScan seen = to_the_front.scan(straightDrive(1, 0.0), 0);
  double leftmost_rad = 0.0, rightmost_rad = 0.0;
  for (const LidarPoint& point : seen.points) {
    leftmost_rad = std::max(leftmost_rad, wrappedAngle(azimuthOf(point)));
    rightmost_rad = std::min(rightmost_rad, wrappedAngle(azimuthOf(point)));
  }
  const double step_rad = 2.0 * kPi / options.firings_per_turn;
  EXPECT_NEAR(leftmost_rad, kPi / 3.0, step_rad);
  EXPECT_NEAR(rightmost_rad, -kPi / 3.0, step_rad);
  EXPECT_NEAR(static_cast<double>(seen.points.size()), static_cast<double>(all.points.size()) / 3.0,
              0.1 * static_cast<double>(all.points.size()));
}

TEST(LidarSimulator, ATiltedLidarSeesTheSameSceneFromItsPose) {
  for (const auto& [roll_deg, pitch_deg] : {std::pair<double, double>{180.0, 0.0}, {-25.0, 15.0}}) {
    LidarOptions options = perfectLidar();
    options.mounting_roll_deg = roll_deg;
    options.mounting_pitch_deg = pitch_deg;
    LidarSimulator simulator(sceneOf({ground()}), options);
    const VehicleMotion motion = straightDrive(1, 0.0).withMounting(options.R_vehicle_lidar());
    const LidarScan scan = simulator.scan(motion, 0);
    EXPECT_GT(scan.points.size(), 3000U);
    for (const LidarPoint& point : scan.points) {
      EXPECT_NEAR((motion.T_scene_lidar[0] * positionOf(point).cast<double>()).z(), 0.0, 1e-3);
    }
  }
}

TEST(LidarSimulator, TheVehicleHidesTheSameGroundFromATiltedLidar) {
  // The beams lie alike above and below the horizon, so that upside down it sees what it saw upright.
  LidarOptions options = perfectLidar();
  options.sensor = SensorModel::evenlySpaced("even", 32, 1800, 30.0, -30.0);
  options.own_vehicle = LidarOptions().own_vehicle;
  const auto pointCount = [&](double roll_deg) {
    options.mounting_roll_deg = roll_deg;
    LidarSimulator simulator(sceneOf({ground()}), options);
    const VehicleMotion motion = straightDrive(1, 0.0).withMounting(options.R_vehicle_lidar());
    return static_cast<double>(simulator.scan(motion, 0).points.size());
  };
  const double upright = pointCount(0.0);
  EXPECT_NEAR(pointCount(180.0), upright, 0.01 * upright);
  options.own_vehicle.setEmpty();
  EXPECT_GT(pointCount(180.0), upright + 2000.0);
}

TEST(LidarSimulator, AnEmptySceneGivesAnEmptyScan) {
  LidarSimulator simulator(Scene{}, LidarOptions{});
  EXPECT_TRUE(simulator.scan(straightDrive(1, 0.0), 0).points.empty());
}

TEST(LidarSimulator, NamesWhatIsWrong) {
  LidarOptions options;
  options.max_range_m = -1.0;
  expectThrows<std::invalid_argument>([&] { LidarSimulator simulator(Scene(), options); }, {"max_range_m = -1"});
  LidarSimulator simulator(sceneOf({ground()}), LidarOptions());
  VehicleMotion motion = straightDrive(2, 0.0);
  expectThrows<std::out_of_range>([&] { simulator.scan(motion, 2); }, {"scan 2"});
  expectThrows<std::out_of_range>([&] { simulator.scan(motion, -1); }, {"scan -1"});
  motion.T_scene_lidar[1].translation().x() = std::numeric_limits<double>::infinity();
  expectThrows<std::invalid_argument>([&] { simulator.scan(motion, 1); }, {"scan 1", "finite"});
  motion.T_scene_lidar.pop_back();
  expectThrows<std::invalid_argument>([&] { simulator.scan(motion, 0); }, {"T_scene_lidar.size() = 1"});
}

}  // namespace
}  // namespace saw_ndt
