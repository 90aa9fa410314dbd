#include "drives/ground_heights.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace saw_ndt::internal {
namespace {

using Point = std::array<float, 3>;

/// Ground of a slope along x over 40 m by 20 m, 20 points a square metre, with 2 cm of noise.
std::vector<Point> slope(double rise) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> x(-20.0F, 20.0F), y(-10.0F, 10.0F);
  std::normal_distribution<float> noise(0.0F, 0.02F);
  std::vector<Point> points(16000);
  for (Point& point : points) {
    point = {x(random), y(random), 0.0F};
    point[2] = static_cast<float>(rise) * point[0] + noise(random);
  }
  return points;
}

GroundSurface surfaceOf(const std::vector<Point>& points) {
  LowestHeights heights;
  for (const Point& point : points) heights.add(point.data());
  return heights.surface();
}

double groundShare(const GroundSurface& surface, const std::vector<Point>& points) {
  const auto ground =
      std::count_if(points.begin(), points.end(), [&](const Point& p) { return surface.isGround(p.data()); });
  return static_cast<double>(ground) / static_cast<double>(points.size());
}

TEST(GroundHeights, SlopesAreGroundAndWhatStandsOnThemIsNot) {
  for (const double rise : {-0.25, 0.0, 0.1, 0.25}) {
    const std::vector<Point> ground = slope(rise);
    std::vector<Point> all = ground, standing;
    for (int i = 0; i < 3000; ++i) {  // a box, seen from above and from the side, and a wall
      const float x = 2.0F * static_cast<float>(i) / 3000.0F, height = 0.4F + 0.001F * static_cast<float>(i % 1200);
      standing.push_back({x, 4.0F, static_cast<float>(rise) * x + height});
      standing.push_back({x, 4.0F + 0.001F * static_cast<float>(i % 2000), static_cast<float>(rise) * x + 1.6F});
      standing.push_back({5.0F, x, static_cast<float>(rise) * 5.0F + 0.4F + 0.002F * static_cast<float>(i)});
    }
    all.insert(all.end(), standing.begin(), standing.end());
    const GroundSurface surface = surfaceOf(all);
    EXPECT_GT(groundShare(surface, ground), 0.999) << rise;
    EXPECT_LT(groundShare(surface, standing), 0.001) << rise;
  }
}

TEST(GroundHeights, OutliersBelowDoNotTakeTheGroundAway) {
  const std::vector<Point> ground = slope(0.05);
  std::vector<Point> all = ground;
  for (int i = 0; i < 16; ++i) all.push_back({-15.5F + 2.0F * static_cast<float>(i), 0.5F, -3.0F});
  // A place where many of them lie, as of a mirror.
  for (int i = 0; i < 50; ++i) all.push_back({10.2F + 0.01F * static_cast<float>(i), 5.5F, -2.0F});
  EXPECT_GT(groundShare(surfaceOf(all), ground), 0.999);
}

TEST(GroundHeights, WithoutGroundAroundNothingIsGround) {
  EXPECT_FALSE(GroundSurface().isGround(Point{1.0F, 2.0F, 3.0F}.data()));
  const GroundSurface far_off = surfaceOf(slope(0.0));
  EXPECT_FALSE(far_off.isGround(Point{100.0F, 0.0F, 0.0F}.data()));
  EXPECT_FALSE(far_off.isGround(Point{3e30F, 0.0F, 0.0F}.data()));
  EXPECT_FALSE(far_off.isGround(Point{std::nanf(""), 0.0F, 0.0F}.data()));
}

}  // namespace
}  // namespace saw_ndt::internal
