#include "saw_ndt/map/map_region.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace saw_ndt {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<MapRegion> regions() {
  const std::vector<Eigen::Vector2d> star = {{-40.0, -30.0}, {5.0, -5.0}, {45.0, -35.0}, {10.0, 0.0},  {30.0, 40.0},
                                             {0.0, 10.0},    {-5.0, 9.5}, {-35.0, 35.0}, {-12.0, 2.0}, {-33.0, -7.0}};
  const MapRegion high = boxRegion({-kInfinity, -kInfinity, 3.0}, {kInfinity, kInfinity, 9.0});
  return {boxRegion({-13.0, 2.5, -4.0}, {7.0, 11.0, 30.0}),
          high,
          polygonRegion(star),
          regionAround(star, 2.5),
          regionAround({{3.0, -2.0}}, 11.0),
          commonRegion(high, polygonRegion(star))};
}

TEST(MapRegion, ABoxThatHoldsAPositionOfItMayMeetIt) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> anywhere(-50.0, 50.0), share(0.0, 1.0);
  for (const MapRegion& region : regions()) {
    int belong = 0, ruled_out = 0;
    for (int trial = 0; trial < 20000; ++trial) {
      const Eigen::Vector3d least(anywhere(random), anywhere(random), 0.4 * anywhere(random));
      const Eigen::Vector3d size = 15.0 * Eigen::Vector3d(share(random), share(random), share(random));
      const Eigen::Vector3d position =
          least + Eigen::Vector3d(share(random), share(random), share(random)).cwiseProduct(size);
      const bool may_meet = region.mayMeet({least, least + size});
      if (region(position)) {
        EXPECT_TRUE(may_meet) << position.transpose();
        ++belong;
      }
      if (!may_meet) ++ruled_out;
    }
    EXPECT_GT(belong, 100);
    EXPECT_GT(ruled_out, 3000);
  }
}

TEST(MapRegion, BelongsToBothOfTwoRegions) {
  const MapRegion common = commonRegion(boxRegion({0.0, 0.0, 0.0}, {2.0, 2.0, 2.0}), regionAround({{0.0, 0.0}}, 1.0));
  EXPECT_TRUE(common({0.5, 0.5, 1.0}));
  EXPECT_FALSE(common({-0.5, 0.5, 1.0}));
  EXPECT_FALSE(common({1.5, 1.5, 1.0}));
}

TEST(MapRegion, OfAFunctionAnyBoxMayMeet) {
  const MapRegion region = [](const Eigen::Vector3d& position_m) { return position_m.x() > 5.0; };
  EXPECT_TRUE(region({6.0, 0.0, 0.0}));
  EXPECT_FALSE(region({4.0, 0.0, 0.0}));
  EXPECT_TRUE(region.mayMeet({Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones()}));
}

}  // namespace
}  // namespace saw_ndt
