#include "saw_ndt/evaluation/pose_errors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "expect_throws.h"

namespace saw_ndt {
namespace {

using Unit = RelativeErrorOptions::Unit;
using Places = std::vector<std::pair<std::size_t, std::size_t>>;

Places placesOf(const std::vector<RelativePoseError>& errors) {
  Places places;
  for (const RelativePoseError& error : errors) places.emplace_back(error.first, error.last);
  return places;
}

RelativeErrorOptions over(double delta, Unit unit, bool all_pairs = false, bool way_of_reference = false) {
  RelativeErrorOptions options;
  options.delta = delta;
  options.unit = unit;
  options.all_pairs = all_pairs;
  options.way_of_reference = way_of_reference;
  return options;
}

/// A straight drive with a pose every metre, whose estimate goes 1.1 m instead, and turns where `yaw_deg` says so.
std::vector<PosePair> straightDrive(std::size_t poses, double yaw_deg = 0.0) {
  std::vector<PosePair> pairs(poses);
  for (std::size_t i = 0; i < poses; ++i) {
    const auto metres = static_cast<double>(i);
    pairs[i].T_map_reference.translation().x() = metres;
    pairs[i].T_map_estimate =
        transformFromXyzRpy((Vector6d() << 1.1 * metres, 0, 0, 0, 0, radiansFromDegrees(yaw_deg * metres)).finished());
  }
  return pairs;
}

TEST(ErrorStatistics, AreThoseOfTheirDefinitions) {
  const ErrorStatistics statistics = errorStatistics({3.0, 0.0, 5.0, 4.0});
  EXPECT_DOUBLE_EQ(statistics.rmse, std::sqrt(12.5));
  EXPECT_DOUBLE_EQ(statistics.mean, 3.0);
  EXPECT_DOUBLE_EQ(statistics.median, 3.5);
  EXPECT_DOUBLE_EQ(statistics.std, std::sqrt(3.5));
  EXPECT_EQ(statistics.min, 0.0);
  EXPECT_EQ(statistics.max, 5.0);
  EXPECT_DOUBLE_EQ(statistics.sse, 50.0);
  EXPECT_THROW(errorStatistics({}), std::invalid_argument);
}

// A rotation R by a is off the identity by |R - I|^2 = 4 (1 - cos a): 4 for 90 degrees, 8 for 180.
TEST(AbsolutePoseErrors, OfTranslationRotationAndBoth) {
  std::vector<PosePair> pairs(3);
  pairs[0].T_map_reference = transformFromXyzRpy((Vector6d() << 1, 2, 3, 0, 0, 0.3).finished());
  pairs[0].T_map_estimate = pairs[0].T_map_reference;
  pairs[1].T_map_reference = pairs[0].T_map_reference;
  pairs[1].T_map_estimate =
      pairs[1].T_map_reference * transformFromXyzRpy((Vector6d() << 0, 3, 4, kPi / 2, 0, 0).finished());
  pairs[2].T_map_estimate = transformFromXyzRpy((Vector6d() << 1, 0, 0, 0, 0, kPi).finished());
  const PoseErrorStatistics errors = absolutePoseErrors(pairs);
  EXPECT_NEAR(errors.translation_m.mean, 2.0, 1e-12);
  EXPECT_NEAR(errors.translation_m.max, 5.0, 1e-12);
  EXPECT_NEAR(errors.translation_m.sse, 26.0, 1e-12);
  EXPECT_NEAR(errors.rotation_deg.mean, 90.0, 1e-9);
  EXPECT_NEAR(errors.rotation_deg.max, 180.0, 1e-9);
  EXPECT_NEAR(errors.full.max, std::sqrt(25.0 + 4.0), 1e-12);
  EXPECT_NEAR(errors.full.median, std::sqrt(1.0 + 8.0), 1e-12);
}

TEST(RelativePoseErrors, OverFrames) {
  const auto one_after_another = relativePoseErrors(straightDrive(6, 3.0), over(2, Unit::FRAMES));
  EXPECT_EQ(placesOf(one_after_another), (Places{{0, 2}, {2, 4}}));
  for (const RelativePoseError& error : one_after_another) EXPECT_NEAR(error.rotation_deg, 6.0, 1e-9);
  const auto all = relativePoseErrors(straightDrive(6), over(2, Unit::FRAMES, true));
  EXPECT_EQ(placesOf(all), (Places{{0, 2}, {1, 3}, {2, 4}, {3, 5}}));
  const PoseErrorStatistics statistics = statisticsOf(all);
  EXPECT_NEAR(statistics.translation_m.rmse, 0.2, 1e-12);
  EXPECT_NEAR(statistics.translation_m.sse, 0.16, 1e-12);
  EXPECT_NEAR(statistics.full.max, 0.2, 1e-12);
  EXPECT_EQ(placesOf(relativePoseErrors(straightDrive(6), over(5, Unit::FRAMES, true))), (Places{{0, 5}}));
}

// The estimate turns by a quarter at the second pose: its motion from there is (0, 2.2) where the reference's is (2,
// 0), turned into the pose's own frame (2.2, 0) rotated by -90 degrees.
TEST(RelativePoseErrors, AreInTheFrameOfTheFirstPose) {
  std::vector<PosePair> pairs = straightDrive(4);
  pairs[1].T_map_estimate.linear() = Eigen::AngleAxisd(kPi / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const auto errors = relativePoseErrors(pairs, over(2, Unit::FRAMES, true));
  ASSERT_EQ(errors.size(), 2U);
  EXPECT_NEAR(errors[0].translation_m, 0.2, 1e-12);
  EXPECT_NEAR(errors[0].rotation_deg, 0.0, 1e-9);
  EXPECT_NEAR(errors[1].translation_m, std::hypot(2.0, 2.2), 1e-12);
  EXPECT_NEAR(errors[1].rotation_deg, 90.0, 1e-9);
}

TEST(RelativePoseErrors, OverMetresOneAfterAnother) {
  // The estimate has gone 2.1 m after 2 poses, the reference after 3; the way to the first end is not evaluated.
  const auto by_estimate = relativePoseErrors(straightDrive(11), over(2.1, Unit::METRES));
  EXPECT_EQ(placesOf(by_estimate), (Places{{2, 4}, {4, 6}, {6, 8}, {8, 10}}));
  EXPECT_NEAR(statisticsOf(by_estimate).translation_m.mean, 0.2, 1e-12);
  const auto by_reference = relativePoseErrors(straightDrive(11), over(2.1, Unit::METRES, false, true));
  EXPECT_EQ(placesOf(by_reference), (Places{{3, 6}, {6, 9}}));
  EXPECT_NEAR(statisticsOf(by_reference).translation_m.mean, 0.3, 1e-12);
}

TEST(RelativePoseErrors, OverMetresFromEveryPose) {
  // 3 poses are 3.3 m, 0.1 m off; 2 and 4 are farther off.
  RelativeErrorOptions options = over(3.2, Unit::METRES, true);
  EXPECT_EQ(placesOf(relativePoseErrors(straightDrive(7), options)), (Places{{0, 3}, {1, 4}, {2, 5}, {3, 6}}));
  options.relative_tolerance = 0.03;
  expectThrows<std::invalid_argument>([&] { relativePoseErrors(straightDrive(7), options); },
                                      {"no two of the 7 poses are 3.2 m apart"});
  // Of poses that stand, the first is the end.
  std::vector<PosePair> standing = straightDrive(5);
  standing[3] = standing[2];
  EXPECT_EQ(placesOf(relativePoseErrors(standing, over(2.2, Unit::METRES, true))), (Places{{0, 2}, {2, 4}, {3, 4}}));
}

TEST(RelativePoseErrors, WhatCannotBeComparedIsRefused) {
  const auto expectRefused = [](const RelativeErrorOptions& options, const std::string& reason) {
    expectThrows<std::invalid_argument>([&] { relativePoseErrors(straightDrive(3), options); }, {reason});
  };
  expectRefused(over(3, Unit::FRAMES), "no two of the 3 poses are 3 frames apart");
  expectRefused(over(1e9, Unit::FRAMES, true), "frames apart");
  expectRefused(over(100, Unit::METRES), "100 m apart");
  expectRefused(over(100, Unit::METRES, true), "100 m apart");
  expectRefused(over(0, Unit::FRAMES), "delta = 0");
  expectRefused(over(1.5, Unit::FRAMES), "delta = 1.5");
  expectRefused(over(-1, Unit::METRES), "delta = -1");
  expectRefused(over(std::nan(""), Unit::METRES), "delta = nan");
  RelativeErrorOptions options;
  options.relative_tolerance = -0.1;
  expectRefused(options, "relative_tolerance = -0.1");
  expectThrows<std::invalid_argument>([] { relativePoseErrors({}, {}); }, {"0 poses"});
}

}  // namespace
}  // namespace saw_ndt
