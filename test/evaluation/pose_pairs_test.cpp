#include "saw_ndt/evaluation/pose_pairs.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "expect_throws.h"

namespace saw_ndt {
namespace {

StampedPose at(double stamp_s, double x_m, double yaw_deg = 0.0) {
  return {stamp_s, transformFromXyzRpy((Vector6d() << x_m, 0, 0, 0, 0, radiansFromDegrees(yaw_deg)).finished())};
}

std::vector<StampedPose> at(const std::vector<double>& stamps_s) {
  std::vector<StampedPose> poses;
  for (const double stamp_s : stamps_s) poses.push_back(at(stamp_s, stamp_s));
  return poses;
}

/// The stamps of the pairs, reference and estimate, told by x.
std::vector<std::pair<double, double>> stampsOf(const PairedTrajectories& paired) {
  std::vector<std::pair<double, double>> stamps_s;
  for (const PosePair& pair : paired.pairs) {
    stamps_s.emplace_back(pair.T_map_reference.translation().x(), pair.T_map_estimate.translation().x());
  }
  return stamps_s;
}

using Stamps = std::vector<std::pair<double, double>>;

TEST(PosePairs, EachPoseOfTheShorterTrajectoryGetsTheNearestOfTheLonger) {
  const auto slow = at({0.0, 0.1, 0.2}), fast = at({0.001, 0.004, 0.05, 0.098, 0.101, 0.15, 0.204, 0.25});
  const PairedTrajectories fast_estimate = pairTrajectories(slow, fast, {});
  EXPECT_EQ(stampsOf(fast_estimate), (Stamps{{0.0, 0.001}, {0.1, 0.101}, {0.2, 0.204}}));
  EXPECT_EQ(fast_estimate.reference_poses, 3U);
  EXPECT_EQ(fast_estimate.estimate_poses, 8U);
  EXPECT_EQ(fast_estimate.paired_estimates, 3U);
  EXPECT_DOUBLE_EQ(fast_estimate.pairedShare(), 0.375);

  const PairedTrajectories slow_estimate = pairTrajectories(fast, slow, {});
  EXPECT_EQ(stampsOf(slow_estimate), (Stamps{{0.001, 0.0}, {0.101, 0.1}, {0.204, 0.2}}));
  EXPECT_DOUBLE_EQ(slow_estimate.pairedShare(), 1.0);
}

TEST(PosePairs, PosesMayShareOneOfTheOtherTrajectory) {
  const auto estimates = pairTrajectories(at({0.0, 1.0, 2.0}), at({0.992, 1.0, 1.008}), {});
  EXPECT_EQ(stampsOf(estimates), (Stamps{{1.0, 0.992}, {1.0, 1.0}, {1.0, 1.008}}));
  EXPECT_EQ(estimates.paired_estimates, 3U);
  const auto references = pairTrajectories(at({0.0, 0.004}), at({0.002, 5.0, 6.0}), {});
  EXPECT_EQ(stampsOf(references), (Stamps{{0.0, 0.002}, {0.004, 0.002}}));
  EXPECT_EQ(references.paired_estimates, 1U);
  EXPECT_DOUBLE_EQ(references.pairedShare(), 1.0 / 3.0);
}

TEST(PosePairs, TheGreatestDifferenceIsAnOption) {
  const auto reference = at({0.0, 1.0, 2.0}), estimate = at({0.0, 1.25, 2.5});
  PairingOptions options;
  options.max_difference_s = 0.0;
  EXPECT_EQ(stampsOf(pairTrajectories(reference, estimate, options)), (Stamps{{0.0, 0.0}}));
  options.max_difference_s = 0.25;
  EXPECT_EQ(stampsOf(pairTrajectories(reference, estimate, options)), (Stamps{{0.0, 0.0}, {1.0, 1.25}}));
  options.max_difference_s = 0.5;
  EXPECT_EQ(pairTrajectories(reference, estimate, options).pairs.size(), 3U);
}

TEST(PosePairs, TheOffsetIsAddedToTheEstimate) {
  PairingOptions options;
  options.offset_s = 9.5;
  options.skip_s = 1.0;
  const PairedTrajectories paired = pairTrajectories(at({10.0, 11.0, 12.0}), at({0.5, 1.5, 2.5}), options);
  EXPECT_EQ(stampsOf(paired), (Stamps{{11.0, 1.5}, {12.0, 2.5}}));
  EXPECT_EQ(paired.pairs.front().stamp_s, 11.0);
  EXPECT_EQ(paired.estimate_poses, 2U);
}

TEST(PosePairs, TheReferenceIsInterpolatedButNotOverGaps) {
  const std::vector<StampedPose> reference{at(0.0, 0.0, 0.0), at(1.0, 2.0, 90.0), at(3.0, 4.0, 90.0)};
  const auto estimate = at({-0.5, 0.25, 1.0, 2.0, 3.0000005, 3.5});
  PairingOptions options;
  options.interpolate = true;
  options.max_difference_s = 0.0;
  const PairedTrajectories paired = pairTrajectories(reference, estimate, options);
  EXPECT_EQ(stampsOf(paired), (Stamps{{0.5, 0.25}, {2.0, 1.0}, {4.0, 3.0000005}}));
  EXPECT_NEAR(heading(paired.pairs[0].T_map_reference), radiansFromDegrees(22.5), 1e-12);
  EXPECT_DOUBLE_EQ(paired.pairedShare(), 0.5);
  options.longest_gap_s = 2.0;
  options.skip_s = 1.0;
  const PairedTrajectories wide = pairTrajectories(reference, estimate, options);
  EXPECT_EQ(stampsOf(wide), (Stamps{{2.0, 1.0}, {3.0, 2.0}, {4.0, 3.0000005}}));
  EXPECT_DOUBLE_EQ(wide.pairedShare(), 0.75);
}

TEST(PosePairs, SaysWhyNoneIsFound) {
  PairingOptions options;
  options.offset_s = 5.0;
  expectThrows<std::invalid_argument>([&] { pairTrajectories(at({0.0}), at({1.0}), options); },
                                      {"within 0.01 s", "6 to 6 s", "offset of 5 s"});
  options.interpolate = true;
  expectThrows<std::invalid_argument>(
      [&] {
        pairTrajectories(at({0.0, 9.0}), at({1.0}), options);
      },
      {"at most 1 s apart are around"});
  const auto expectRefused = [](auto set, const std::string& reason) {
    PairingOptions wrong;
    set(wrong);
    expectThrows<std::invalid_argument>([&] { pairTrajectories(at({0.0}), at({0.0}), wrong); }, {reason});
  };
  expectRefused([](PairingOptions& o) { o.skip_s = -1.0; }, "skip_s = -1");
  expectRefused([](PairingOptions& o) { o.max_difference_s = -1.0; }, "max_difference_s = -1");
  expectRefused([](PairingOptions& o) { o.offset_s = std::numeric_limits<double>::infinity(); }, "offset_s = inf");
  expectRefused([](PairingOptions& o) { o.longest_gap_s = 0.0; }, "longest_gap_s = 0");
}

}  // namespace
}  // namespace saw_ndt
