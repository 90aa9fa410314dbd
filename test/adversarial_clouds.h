#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "localization/synthetic_drive.h"
#include "saw_ndt/common/scan_view.h"
#include "saw_ndt/common/sensor_model.h"

namespace saw_ndt {

/// A cloud that no sensor should give, by its name.
struct AdversarialCloud {
  const char* name;
  std::vector<LidarPoint> (*make)();

  std::vector<LidarPoint> points() const { return make(); }
};

/// The scan of a small LiDAR in the street, as it should be: some 5000 points.
inline std::vector<LidarPoint> streetScan(unsigned seed = 1) {
  SensorModel sensor = SensorModel::named("VLP-16");
  sensor.columns = 450;
  Eigen::Isometry3d T_ground_lidar = Eigen::Isometry3d::Identity();
  T_ground_lidar.translation() << -5.0, -2.0, 1.73;
  return scanBlocks(streetBlocks(), sensor, T_ground_lidar, seed);
}

namespace adversarial {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kGreatest = std::numeric_limits<float>::max();

using Points = std::vector<LidarPoint>;

/// So many points, each by its number.
template <typename Make>
Points pointsBy(int count, const Make& make) {
  Points points;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3f position = make(i);
    points.push_back({position.x(), position.y(), position.z(), 0.5F});
  }
  return points;
}

/// So many points at random in a cube about the origin.
inline Points cube(int count, float half_edge_m, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> along(-half_edge_m, half_edge_m);
  return pointsBy(count, [&](int) { return Eigen::Vector3f(along(random), along(random), along(random)); });
}

/// The street, each point changed.
template <typename Change>
Points street(const Change& change) {
  Points points = streetScan();
  for (LidarPoint& point : points) change(point);
  return points;
}

/// The street among as many points that are none.
inline Points streetAmongGarbage() {
  const float garbage[] = {kNan, kInfinity, -kInfinity, 1e30F, -1e30F, kGreatest, -kGreatest, 2e9F};
  Points mixed;
  std::size_t next = 0;
  for (const LidarPoint& point : streetScan()) {
    mixed.push_back(point);
    const float value = garbage[next++ % std::size(garbage)];
    LidarPoint bad = next % 7 == 0 ? LidarPoint() : point;
    (next % 3 == 0 ? bad.x : next % 3 == 1 ? bad.y : bad.z) = value;
    mixed.push_back(bad);
  }
  return mixed;
}

}  // namespace adversarial

/// Every kind.
inline std::vector<AdversarialCloud> adversarialClouds() {
  using namespace adversarial;
  using V = Eigen::Vector3f;
  return {
      {"Empty", [] { return Points(); }},
      {"OnePoint",
       [] {
         return Points{{5.0F, 1.0F, -1.0F, 0.5F}};
       }},
      {"Zeros", [] { return Points(3000); }},
      {"NegativeZeros",
       [] {
         return Points(3000, {-0.0F, -0.0F, -0.0F, 0.5F});
       }},
      {"NotANumber",
       [] {
         return Points(3000, {kNan, kNan, kNan, kNan});
       }},
      {"OneCoordinateNotANumber",
       [] {
         return pointsBy(
             3000, [](int i) { return V(i % 3 ? 4.0F : kNan, i % 3 == 1 ? kNan : 3.0F, i % 3 == 2 ? kNan : 1.0F); });
       }},
      {"Infinite",
       [] {
         return pointsBy(3000, [](int i) {
           return V(i % 2 ? kInfinity : 1.0F, i % 3 ? -kInfinity : 2.0F, i % 5 ? kInfinity : -kInfinity);
         });
       }},
      {"Subnormal",
       [] { return pointsBy(3000, [](int i) { return V(1e-45F * static_cast<float>(i), -1e-40F, 1e-39F); }); }},
      {"Tiny", [] { return cube(3000, 1e-20F); }},
      {"Kilometres", [] { return cube(3000, 1e5F); }},
      {"AtTheEndOfReach", [] { return cube(3000, 1e9F); }},
      {"Far", [] { return cube(3000, 1e30F); }},
      {"Greatest",
       [] {
         return pointsBy(3000, [](int i) {
           return V(i % 2 ? kGreatest : -kGreatest, i % 3 ? kGreatest : 0.0F, i % 5 ? -kGreatest : 1.0F);
         });
       }},
      {"FarTogether", [] { return street([](LidarPoint& p) { p.x += 5e8F; }); }},
      {"AllEqual",
       [] {
         return Points(3000, {12.3F, -4.5F, 1.2F, 0.5F});
       }},
      {"TwoPlaces",
       [] { return pointsBy(3000, [](int i) { return i % 2 ? V(6.0F, 1.0F, 0.5F) : V(-6.0F, 2.0F, 0.5F); }); }},
      {"LineAhead",
       [] { return pointsBy(3000, [](int i) { return V(0.01F * static_cast<float>(i) + 1.0F, 0.0F, 0.0F); }); }},
      {"LineUp", [] { return pointsBy(3000, [](int i) { return V(5.0F, 0.0F, 0.01F * static_cast<float>(i)); }); }},
      {"LineAcross",
       [] {
         return pointsBy(
             3000, [](int i) { return V(0.01F * static_cast<float>(i) * V(1.0F, -2.0F, 0.5F) + V(2.0F, 0.0F, 0.0F)); });
       }},
      {"ExactPlane",
       [] {
         return pointsBy(4900, [](int i) {
           return V(0.5F * static_cast<float>(i % 70) - 17.0F, 0.5F * static_cast<float>(i / 70) - 17.0F, -1.7F);
         });
       }},
      {"ExactWall",
       [] {
         return pointsBy(4900, [](int i) {
           return V(0.2F * static_cast<float>(i % 70) - 7.0F, 6.0F, 0.1F * static_cast<float>(i / 70) - 2.0F);
         });
       }},
      {"VoxelCorners",
       [] {
         return pointsBy(4096, [](int i) {
           return V(static_cast<float>(i % 16 - 8), static_cast<float>(i / 16 % 16 - 8),
                    static_cast<float>(i / 256 - 8));
         });
       }},
      {"Noise", [] { return cube(6000, 40.0F); }},
      {"Sphere",
       [] {
         Points points = cube(6000, 1.0F);
         for (LidarPoint& p : points) positionOf(p) = 10.0F * positionOf(p).normalized();
         return points;
       }},
      {"Column", [] { return pointsBy(3000, [](int i) { return V(0.01F * static_cast<float>(i), 0.0F, -1.7F); }); }},
      {"UpsideDown",
       [] {
         return street([](LidarPoint& p) {
           p.y = -p.y;
           p.z = -p.z;
         });
       }},
      {"Mirrored", [] { return street([](LidarPoint& p) { p.y = -p.y; }); }},
      {"Backwards",
       [] {
         return street([](LidarPoint& p) {
           p.x = -p.x;
           p.y = -p.y;
         });
       }},
      {"OnItsSide", [] { return street([](LidarPoint& p) { std::swap(p.y, p.z); }); }},
      {"Twice",
       [] {
         Points points = streetScan();
         const Points once = points;
         points.insert(points.end(), once.begin(), once.end());
         return points;
       }},
      {"Scaled", [] { return street([](LidarPoint& p) { positionOf(p) *= 1.3F; }); }},
      {"Shuffled",
       [] {
         Points points = streetScan();
         std::shuffle(points.begin(), points.end(), std::mt19937(1));
         return points;
       }},
      {"AmongGarbage", streetAmongGarbage},
  };
}

/// Calls check(points) for each.
template <typename Check>
void forEveryAdversarialCloud(const Check& check) {
  for (const AdversarialCloud& cloud : adversarialClouds()) {
    SCOPED_TRACE(cloud.name);
    check(cloud.points());
  }
}

}  // namespace saw_ndt
