#include "simulation/route.h"

#include <gtest/gtest.h>

#include <cmath>

#include "expect_throws.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt {
namespace {

std::vector<std::uint32_t> all(const Route& route) { return route.stationsNear({0.0, 0.0}, 1e4); }

TEST(Route, ACircleClosesAndHasItsRadius) {
  SceneDescription scene;
  scene.course = {{2.0 * kPi * 100.0, 360.0}};
  const Route route = Route::fromCourse(scene, 1);
  ASSERT_EQ(route.stations().size(), 628U);
  // Chords of one metre: the circle through their ends differs from the stated one by less than a millimetre and the
  // rounding of its length to whole metres moves its middle by up to 0.1 m.
  const Eigen::Vector2d centre(0.0, 100.0);
  for (const RouteStation& station : route.stations()) {
    EXPECT_NEAR((station.position.head<2>() - centre).norm(), 100.0, 0.11);
  }
  EXPECT_LT((route.stations().back().position - route.stations().front().position).norm(), 1.1);
}

TEST(Route, PositionsAreResampledEveryMetre) {
  std::vector<Eigen::Vector3d> positions;
  for (int i = 0; i < 5; ++i) positions.emplace_back(3.7 * i, 0.0, 0.37 * i);
  const Route route = Route::throughPositions(positions);
  ASSERT_EQ(route.stations().size(), 15U);
  for (std::size_t i = 0; i < 15; ++i) {
    EXPECT_LT((route.stations()[i].position - Eigen::Vector3d(1.0, 0.0, 0.1) * static_cast<double>(i)).norm(), 1e-12);
    EXPECT_NEAR(route.stations()[i].slope, 0.1, 1e-12);
  }
  EXPECT_LT((route.at(2.25).position - Eigen::Vector3d(2.25, 0.0, 0.225)).norm(), 1e-12);
  EXPECT_LT((route.at(-3.0).position - Eigen::Vector3d(-3.0, 0.0, -0.3)).norm(), 1e-12);
  EXPECT_LT((route.at(20.0).position - Eigen::Vector3d(20.0, 0.0, 2.0)).norm(), 1e-12);
}

TEST(Route, FindsStationsAsASearchThroughAllDoes) {
  SceneDescription scene;
  scene.course = {{200.0, 200.0}, {100.0, 0.0}, {150.0, -250.0}};
  const Route route = Route::fromCourse(scene, 1);
  for (const Eigen::Vector2d& point : {Eigen::Vector2d(3, 4), Eigen::Vector2d(-40, 70), Eigen::Vector2d(900, 0)}) {
    std::vector<std::uint32_t> expected;
    for (std::uint32_t i = 0; i < route.stations().size(); ++i) {
      if ((route.stations()[i].position.head<2>() - point).norm() <= 37.5) expected.push_back(i);
    }
    EXPECT_EQ(route.stationsNear(point, 37.5), expected);
  }
}

TEST(Route, EdgeDistanceTellsLeftFromRight) {
  std::vector<Eigen::Vector3d> positions = {{0, 0, 0}, {50, 0, 0}};
  const Route route = Route::throughPositions(positions);
  const RoadDescription road{5.0, 2.0, 0.0, 0.0};
  EXPECT_NEAR(roadEdgeDistance(route, all(route), road, {20.3, 7.0}), 2.0, 1e-12);
  EXPECT_NEAR(roadEdgeDistance(route, all(route), road, {20.3, -3.0}), 1.0, 1e-12);
  EXPECT_NEAR(roadEdgeDistance(route, all(route), road, {20.3, 0.0}), -2.0, 1e-12);
  EXPECT_NEAR(roadEdgeDistance(route, all(route), road, {20.3, 4.5}), -0.5, 1e-12);
  EXPECT_TRUE(std::isinf(roadEdgeDistance(route, {}, road, {0, 0})));
}

TEST(Route, RefusesWhatIsNoWay) {
  expectThrows<std::invalid_argument>([] { Route::throughPositions({}); }, {"trajectory length"});
  expectThrows<std::invalid_argument>([] { Route::throughPositions({{0, 0, 0}, {1, 0, 0}}); }, {"trajectory length"});
  expectThrows<std::invalid_argument>([] { Route::throughPositions({{0, 0, 0}, {NAN, 0, 0}}); }, {"position"});
  expectThrows<std::invalid_argument>([] { Route::throughPositions({{0, 0, 0}, {1e9, 0, 0}}); }, {"position"});
  expectThrows<std::invalid_argument>([] { Route::fromCourse({}, 1); }, {"course"});
}

}  // namespace
}  // namespace saw_ndt
