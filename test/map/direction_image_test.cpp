#include "map/direction_image.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "saw_ndt/common/geometry.h"

namespace saw_ndt::internal {
namespace {

LidarPoint pointAt(double azimuth_deg, double elevation_deg, double range_m) {
  const double azimuth = radiansFromDegrees(azimuth_deg), elevation = radiansFromDegrees(elevation_deg);
  LidarPoint point;
  positionOf(point) = (range_m * Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth),
                                                 std::cos(elevation) * std::sin(azimuth), std::sin(elevation)))
                          .cast<float>();
  return point;
}

std::int32_t pixelAt(double azimuth_deg, double elevation_deg) {
  const LidarPoint point = pointAt(azimuth_deg, elevation_deg, 10.0);
  float range_m, horizontal_range_m;
  std::int32_t pixel;
  measureDirections(1, {&point.x, &point.y, &point.z}, DirectionImage::grid(0.0F, 100.0F),
                    {&range_m, &horizontal_range_m, &pixel});
  EXPECT_NEAR(range_m, 10.0F, 1e-5F);
  EXPECT_NEAR(horizontal_range_m, 10.0 * std::cos(radiansFromDegrees(elevation_deg)), 1e-4);
  return pixel;
}

// Rays to a sphere of 20 m around the LiDAR, of rows `step_deg` apart from -20 to 10 degrees.
std::vector<LidarPoint> sphere(double step_deg) {
  std::vector<LidarPoint> points;
  for (double elevation = -20.0; elevation <= 10.0; elevation += step_deg) {
    for (double azimuth = 0.1; azimuth < 360.0; azimuth += 0.2) points.push_back(pointAt(azimuth, elevation, 20.0));
  }
  return points;
}

TEST(DirectionImage, RaysEndBeyondWhatIsNearerThanTheyEnd) {
  const std::vector<LidarPoint> points = sphere(0.4);
  DirectionImage image;
  image.make(viewOf(points), 1.0F);
  for (const double azimuth : {0.0, 0.4, 77.7, 180.0, 359.9}) {
    for (const float reach : {0.1F, 1.5F, 3.0F, 9.0F}) {
      EXPECT_TRUE(image.endsBeyond(pixelAt(azimuth, -5.0), 19.9F, reach)) << azimuth;
      EXPECT_FALSE(image.endsBeyond(pixelAt(azimuth, -5.0), 20.1F, reach)) << azimuth;
    }
  }
  EXPECT_FALSE(image.endsBeyond(pixelAt(10.0, 15.0), 1.0F, 1.0F)) << "no ray goes there";
  EXPECT_FALSE(image.endsBeyond(pixelAt(10.0, -90.0), 1.0F, 1.0F));
  EXPECT_FALSE(image.endsBeyond(pixelAt(10.0, 90.0), 1.0F, 1.0F));
}

// A thing to one side of a direction counts as far as the window reaches, past the seam of azimuths, too.
TEST(DirectionImage, OneNearRayCountsAllAroundIt) {
  for (const double azimuth : {90.25, 0.25, 359.75}) {
    std::vector<LidarPoint> points = sphere(0.4);
    points.push_back(pointAt(azimuth, 0.25, 5.0));
    DirectionImage image;
    image.make(viewOf(points), 1.0F);
    for (const auto& [reach, pixels] : {std::pair(1.0F, 1), {2.0F, 2}, {4.0F, 4}, {8.0F, 8}}) {
      for (int offset = -9; offset <= 9; ++offset) {
        const bool free = std::abs(offset) > pixels;
        EXPECT_EQ(image.endsBeyond(pixelAt(azimuth + 0.5 * offset, 0.25), 6.0F, reach), free) << azimuth << offset;
        EXPECT_EQ(image.endsBeyond(pixelAt(azimuth, 0.25 + 0.5 * offset), 6.0F, reach), free) << azimuth << offset;
      }
    }
  }
}

// Between a ray to near ground and one to what is behind, nothing is known of how far one sees.
TEST(DirectionImage, BetweenTwoBeamsTheNearerCounts) {
  std::vector<LidarPoint> points;
  for (double azimuth = 0.1; azimuth < 360.0; azimuth += 0.2) {
    points.push_back(pointAt(azimuth, -3.0, 10.0));
    points.push_back(pointAt(azimuth, -1.0, 30.0));
  }
  DirectionImage image;
  image.make(viewOf(points), 1.0F);
  EXPECT_FALSE(image.endsBeyond(pixelAt(50.0, -2.0), 9.0F, 1.0F)) << "no ray passes there";
  EXPECT_FALSE(image.endsBeyond(pixelAt(50.0, -1.0), 20.0F, 1.0F)) << "just below, one sees 10 m";
  EXPECT_TRUE(image.endsBeyond(pixelAt(50.0, -1.0), 9.0F, 1.0F));
  EXPECT_FALSE(image.endsBeyond(pixelAt(50.0, -3.0), 20.0F, 1.0F));
}

TEST(DirectionImage, KeepsNothingOfTheScanBefore) {
  DirectionImage image;
  std::vector<LidarPoint> near = sphere(0.4);
  for (LidarPoint& point : near) positionOf(point) *= 0.25F;
  image.make(viewOf(near), 1.0F);
  EXPECT_FALSE(image.endsBeyond(pixelAt(10.0, 0.0), 10.0F, 1.0F));
  image.make(viewOf(std::vector<LidarPoint>{pointAt(10.0, 0.0, 30.0)}), 1.0F);
  EXPECT_TRUE(image.endsBeyond(pixelAt(10.0, 0.0), 10.0F, 8.0F));
  EXPECT_FALSE(image.endsBeyond(pixelAt(11.0, 0.0), 1.0F, 1.0F));
  image.make(viewOf(std::vector<LidarPoint>{}), 1.0F);
  EXPECT_FALSE(image.endsBeyond(pixelAt(10.0, 0.0), 10.0F, 1.0F));
}

TEST(DirectionImage, PointsThatAreNoneOrOfTheVehicleAreLeftOut) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
  std::vector<LidarPoint> points = sphere(0.4);
  for (const float bad : {kNan, kInfinity, -kInfinity, 3e38F, 0.0F}) {
    points.push_back({bad, 0.0F, 0.0F, 0.0F});
    points.push_back({bad, bad, bad, 0.0F});
  }
  points.push_back(pointAt(10.0, 0.0, 2.0));
  DirectionImage image;
  image.make(viewOf(points), 2.5F);
  EXPECT_TRUE(image.endsBeyond(pixelAt(10.0, 0.0), 19.0F, 8.0F));
  EXPECT_TRUE(image.endsBeyond(pixelAt(0.0, 0.0), 19.0F, 8.0F));
}

}  // namespace
}  // namespace saw_ndt::internal
