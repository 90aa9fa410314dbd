#include "report/segmentation_score.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "expect_throws.h"

namespace saw_ndt {
namespace {

constexpr auto kNoise = StructuralLabel::NOISE;
constexpr auto kGround = StructuralLabel::GROUND;
constexpr auto kOther = StructuralLabel::NON_GROUND;

TEST(SegmentationScore, KnowsTheGroundClasses) {
  std::vector<int> ground;
  for (int i = 0; i < 300; ++i) {
    if (isSemanticKittiGround(static_cast<std::uint16_t>(i))) ground.push_back(i);
  }
  EXPECT_EQ(ground, (std::vector<int>{40, 44, 48, 49, 60, 72}));
}

TEST(SegmentationScore, ByHand) {
  // Ground found 3 times (40, 48, 72), missed twice (40 as noise, 49 as non-ground); a car (10) and a wall (50) taken
  // for ground; a tree (71) rejected, a pole (80) kept. Classes 0 and 1 do not count, whatever the label.
  const std::vector<StructuralLabel> labels{kGround, kGround, kGround, kNoise,  kOther,  kGround,
                                            kGround, kNoise,  kOther,  kGround, kGround, kNoise};
  const std::vector<std::uint16_t> classes{40, 48, 72, 40, 49, 10, 50, 71, 80, 0, 1, 0};
  const GroundScore score = scoreGround(labels, classes);
  EXPECT_EQ(score.points, 12U);
  EXPECT_EQ(score.noise_points, 3U);
  EXPECT_EQ(score.true_positives, 3U);
  EXPECT_EQ(score.false_positives, 2U);
  EXPECT_EQ(score.false_negatives, 2U);
  EXPECT_EQ(score.true_negatives, 2U);
  EXPECT_DOUBLE_EQ(score.precision(), 3.0 / 5.0);
  EXPECT_DOUBLE_EQ(score.recall(), 3.0 / 5.0);
  EXPECT_DOUBLE_EQ(score.f1(), 6.0 / 10.0);
  EXPECT_DOUBLE_EQ(score.iou(), 3.0 / 7.0);
  EXPECT_DOUBLE_EQ(score.noiseShare(), 0.25);
  const auto json = nlohmann::json::parse(toJsonText(score));
  EXPECT_DOUBLE_EQ(json.at("iou"), 3.0 / 7.0);
  EXPECT_DOUBLE_EQ(json.at("noise_share"), 0.25);
  EXPECT_EQ(json.at("false_negatives"), 2);
}

TEST(SegmentationScore, ScansAddUp) {
  GroundScore sum = scoreGround({kGround, kNoise}, {40, 40});
  sum += scoreGround({kGround, kGround, kOther}, {50, 72, 50});
  EXPECT_EQ(sum.points, 5U);
  EXPECT_EQ(sum.noise_points, 1U);
  EXPECT_DOUBLE_EQ(sum.precision(), 2.0 / 3.0);
  EXPECT_DOUBLE_EQ(sum.recall(), 2.0 / 3.0);
  EXPECT_EQ(sum.true_negatives, 1U);
}

TEST(SegmentationScore, NothingToDivideBy) {
  const GroundScore score = scoreGround({kOther}, {50});
  EXPECT_EQ(score.precision(), 0.0);
  EXPECT_EQ(score.recall(), 0.0);
  EXPECT_EQ(score.f1(), 0.0);
  EXPECT_EQ(score.iou(), 0.0);
  EXPECT_EQ(GroundScore().noiseShare(), 0.0);
  expectThrows<std::invalid_argument>([] { scoreGround({kOther}, {50, 40}); }, {"2 classes for 1 points"});
}

}  // namespace
}  // namespace saw_ndt
