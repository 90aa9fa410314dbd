#include "saw_ndt/evaluation/relative_errors.h"

#include <gtest/gtest.h>

#include "saw_ndt/common/geometry.h"

namespace saw_ndt {
namespace {

/// A straight drive with a pose every metre, whose estimate has an error of scale and turns away steadily.
std::vector<PosePair> straightDrive(int metres, double scale, double yaw_deg_per_m) {
  std::vector<PosePair> pairs;
  for (int i = 0; i <= metres; ++i) {
    PosePair pair;
    pair.stamp_s = 0.1 * i;
    pair.T_map_reference.translation().x() = i;
    pair.T_map_estimate =
        transformFromXyzRpy((Vector6d() << scale * i, 0, 0, 0, 0, radiansFromDegrees(yaw_deg_per_m * i)).finished());
    pairs.push_back(pair);
  }
  return pairs;
}

TEST(KittiRelativeErrors, ScaleErrorOfOnePercent) {
  const auto errors = kittiRelativeErrors(straightDrive(1000, 1.01, 0.0));
  ASSERT_TRUE(errors.has_value());
  // A segment ends at the first pose beyond its length, a metre later: 1 % of 101 m over 100 m, and so on.
  EXPECT_NEAR(errors->translation_percent, 1.0, 0.011);
  EXPECT_GT(errors->translation_percent, 1.0);
  EXPECT_NEAR(errors->rotation_deg_per_m, 0.0, 1e-12);
}

TEST(KittiRelativeErrors, SteadyTurn) {
  const auto errors = kittiRelativeErrors(straightDrive(105, 1.0, 0.01));
  ASSERT_TRUE(errors.has_value());
  EXPECT_EQ(errors->segments, 1U);
  EXPECT_NEAR(errors->rotation_deg_per_m, 0.01 * 101.0 / 100.0, 1e-9);
}

TEST(KittiRelativeErrors, CountsSegments) {
  // Starts 0, 10, ... 90 for 100 m (end at most 200), 0 alone is too short for 200 m, whose end is pose 201.
  const auto errors = kittiRelativeErrors(straightDrive(200, 1.0, 0.0));
  ASSERT_TRUE(errors.has_value());
  EXPECT_EQ(errors->segments, 10U);
  EXPECT_NEAR(errors->translation_percent, 0.0, 1e-12);
}

TEST(KittiRelativeErrors, EmptyForAShortDrive) {
  EXPECT_FALSE(kittiRelativeErrors(straightDrive(100, 1.01, 0.0)).has_value());
  EXPECT_FALSE(kittiRelativeErrors({}).has_value());
}

}  // namespace
}  // namespace saw_ndt
