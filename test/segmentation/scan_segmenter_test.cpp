#include "saw_ndt/segmentation/scan_segmenter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "common/instruction_set.h"
#include "segmentation/segmentation_stages.h"
#include "segmentation/synthetic_scan.h"

namespace saw_ndt {

using namespace internal;

namespace {

// One degree between rows, half a degree between columns; row 6 looks level ahead.
SensorModel testSensor() { return SensorModel::evenlySpaced("test", 32, 720, 6.0, -25.0); }

constexpr double kWallDistance = 8.5;  // 0.36 m behind the last return of the ground before it
constexpr int kFirstWallColumn = 100;
constexpr int kEndWallColumn = 140;
constexpr int kWallBottomRow = 17;  // -11 degrees: the first beam above the foot of the wall
constexpr int kWallTopRow = 3;
constexpr int kSpeckleRow = 2;
constexpr int kSpeckleColumn = 300;

bool isWall(int row, int column) {
  return column >= kFirstWallColumn && column < kEndWallColumn && row >= kWallTopRow && row <= kWallBottomRow;
}

// Flat ground, a wall that stands on it, and one return in the sky.
double sceneRange(int row, int column) {
  const SensorModel sensor = testSensor();
  if (row == kSpeckleRow && column == kSpeckleColumn) return 5.0;
  if (isWall(row, column)) return kWallDistance / std::cos(radiansFromDegrees(sensor.elevations_deg[row]));
  return rangeToFlatGround(sensor, row, 40.0);
}

StructuralLabel sceneLabel(int row, int column) {
  if (!std::isfinite(sceneRange(row, column))) return StructuralLabel::NOISE;
  if (row == kSpeckleRow && column == kSpeckleColumn) return StructuralLabel::NOISE;
  return isWall(row, column) ? StructuralLabel::NON_GROUND : StructuralLabel::GROUND;
}

SegmentationOptions testOptions(GroundRule rule) {
  SegmentationOptions options;
  options.sensor = testSensor();
  options.ground.rule = rule;
  return options;
}

void expectSceneLabels(const pcl::PointCloud<pcl::PointXYZ>& scan, const std::vector<StructuralLabel>& labels) {
  const int columns = testSensor().columns;
  ASSERT_EQ(labels.size(), scan.size());
  for (int i = 0; i < static_cast<int>(labels.size()); ++i) {
    ASSERT_EQ(labels[i], sceneLabel(i / columns, i % columns)) << "row " << i / columns << " column " << i % columns;
  }
}

class BothRules : public ::testing::TestWithParam<GroundRule> {};

TEST_P(BothRules, PlaneWallAndSpeckleAreToldApart) {
  const auto scan = organizedScan(testSensor(), sceneRange);
  ScanSegmenter segmenter(testOptions(GetParam()));
  std::vector<StructuralLabel> labels;
  segmenter.segment(viewOf(scan), labels);
  expectSceneLabels(scan, labels);
}

TEST_P(BothRules, NothingOfAnEarlierScanStays) {
  const auto scan = organizedScan(testSensor(), sceneRange);
  const auto other = organizedScan(testSensor(), [](int row, int column) { return 3.0 + 0.3 * ((row + column) % 5); });
  ScanSegmenter segmenter(testOptions(GetParam()));
  std::vector<StructuralLabel> labels;
  segmenter.segment(viewOf(other), labels);
  segmenter.segment(ScanView(), labels);
  EXPECT_TRUE(labels.empty());
  segmenter.segment(viewOf(scan), labels);
  expectSceneLabels(scan, labels);
}

TEST_P(BothRules, EveryReturnOfAPixelHasItsLabel) {
  const auto scan = organizedScan(testSensor(), sceneRange);
  const int columns = testSensor().columns;
  pcl::PointCloud<pcl::PointXYZ> twice;
  for (const auto& point : scan) {
    for (const double turn : {-0.002, 0.002}) {
      pcl::PointXYZ turned = point;
      turned.x = static_cast<float>(std::cos(turn) * point.x - std::sin(turn) * point.y);
      turned.y = static_cast<float>(std::sin(turn) * point.x + std::cos(turn) * point.y);
      twice.push_back(turned);
    }
  }
  twice.width = static_cast<std::uint32_t>(2 * columns);
  twice.height = scan.height;
  ScanSegmenter segmenter(testOptions(GetParam()));
  std::vector<StructuralLabel> labels;
  segmenter.segment(viewOf(twice), labels);
  for (int i = 0; i < static_cast<int>(labels.size()); ++i) {
    const int pixel = i / 2;
    ASSERT_EQ(labels[i], sceneLabel(pixel / columns, pixel % columns)) << pixel;
  }
}

TEST_P(BothRules, CloudsWithoutScanPatternAreLabelledToo) {
  for (const std::size_t size : {std::size_t{1}, std::size_t{3}, std::size_t{5000}}) {
    pcl::PointCloud<pcl::PointXYZ> cloud;
    std::uint32_t state = 12345;
    const auto random = [&state] {
      state = state * 1664525U + 1013904223U;
      return static_cast<float>(state >> 8) / 8388608.0F - 1.0F;
    };
    for (std::size_t i = 0; i < size; ++i) cloud.push_back(pcl::PointXYZ(30 * random(), 30 * random(), 3 * random()));
    ScanSegmenter segmenter(testOptions(GetParam()));
    std::vector<StructuralLabel> first;
    std::vector<StructuralLabel> second;
    segmenter.segment(viewOf(cloud), first);
    segmenter.segment(viewOf(cloud), second);
    EXPECT_EQ(first.size(), size);
    EXPECT_EQ(first, second);
  }
}

TEST_P(BothRules, PointsThatAreNotFiniteAreNoise) {
  auto scan = organizedScan(testSensor(), sceneRange);
  for (std::size_t i = 0; i < scan.size(); i += 3) scan[i].z = std::numeric_limits<float>::infinity();
  for (std::size_t i = 1; i < scan.size(); i += 3) scan[i].x = std::numeric_limits<float>::quiet_NaN();
  for (std::size_t i = 2; i < scan.size(); i += 3) scan[i] = pcl::PointXYZ(0.0F, 0.0F, 0.0F);
  ScanSegmenter segmenter(testOptions(GetParam()));
  std::vector<StructuralLabel> labels;
  segmenter.segment(viewOf(scan), labels);
  EXPECT_EQ(std::count(labels.begin(), labels.end(), StructuralLabel::NOISE),
            static_cast<std::ptrdiff_t>(labels.size()));
}

// Rough surfaces, so that there are components of all sizes, on ground that is there in parts.
double roughRange(int row, int column) {
  const std::uint32_t number = static_cast<std::uint32_t>(row / 3 * 977 + column / 7) * 2654435761U >> 16;
  if (number % 5 == 0) return kNoReturn;
  if (number % 3 == 0) return rangeToFlatGround(testSensor(), row, 40.0);
  return 4.0 + 0.37 * (number % 41) + 0.01 * (column % 7);
}

TEST_P(BothRules, LabelsDependOnNeitherThreadsNorInstructionSet) {
  const SensorModel sensor = testSensor();
  const auto organized = organizedScan(sensor, roughRange);
  auto damaged = ringOrderedScan(sensor, roughRange);
  for (std::size_t i = 0; i < damaged.size(); i += 13) damaged[i].y = std::numeric_limits<float>::quiet_NaN();
  for (std::size_t i = 5; i < damaged.size(); i += 13) damaged[i].z = -std::numeric_limits<float>::infinity();
  auto shuffled = damaged;
  std::reverse(shuffled.begin(), shuffled.end());
  const pcl::PointCloud<pcl::PointXYZ> empty;
  const std::vector<const pcl::PointCloud<pcl::PointXYZ>*> scans = {&organized, &damaged, &shuffled, &empty};
  for (const auto* scan : scans) {
    ScanSegmenter segmenter(testOptions(GetParam()));
    std::vector<StructuralLabel> expected;
    segmenter.segment(viewOf(*scan), expected);
    const std::vector<StructuralLabel> expected_pixels = segmenter.stages().pixel_labels;
    const std::vector<std::int32_t> expected_pixel_of_point = segmenter.stages().image.pixelOfPoint();
    EXPECT_EQ(expected.size(), scan->size());
    for (const InstructionSet set :
         {InstructionSet::BASELINE, InstructionSet::SSE4, InstructionSet::AVX2, InstructionSet::AVX512}) {
      limitInstructionSet(set);
      for (const int threads : {1, 2, 3, 7, 40}) {
        std::vector<StructuralLabel> labels;
        segmenter.segment(viewOf(*scan), labels, threads);
        EXPECT_EQ(labels, expected) << toString(set) << ", " << threads << " threads";
        EXPECT_EQ(segmenter.stages().pixel_labels, expected_pixels);
        EXPECT_EQ(segmenter.stages().image.pixelOfPoint(), expected_pixel_of_point);
      }
    }
  }
}

// The components that flood-filling finds, by LeGO-LOAM's criterion in double precision.
TEST(ComponentFilter, FindsWhatFloodFillingFinds) {
  const SensorModel sensor = testSensor();
  const auto scan = organizedScan(sensor, roughRange);
  ScanSegmenter segmenter(testOptions(GroundRule::GROWING));
  std::vector<StructuralLabel> labels;
  segmenter.segment(viewOf(scan), labels, 3);
  const int columns = sensor.columns;
  const RangeImage& image = segmenter.stages().image;
  const auto isObstacle = [&](int pixel) {
    return image.range()[pixel] > 0.0F && segmenter.stages().pixel_labels[pixel] != StructuralLabel::GROUND;
  };
  const auto connected = [&](int first, int second, double apart_deg) {
    const double apart = radiansFromDegrees(apart_deg);
    const double farther = std::max(image.range()[first], image.range()[second]);
    const double nearer = std::min(image.range()[first], image.range()[second]);
    return std::atan2(nearer * std::sin(apart), farther - nearer * std::cos(apart)) > radiansFromDegrees(60.0);
  };
  std::vector<bool> seen(image.range().size(), false);
  int large = 0, small = 0;
  for (int seed = 0; seed < static_cast<int>(seen.size()); ++seed) {
    if (seen[seed] || !isObstacle(seed)) continue;
    seen[seed] = true;
    std::vector<int> component = {seed};
    int points = 0, top_row = seed / columns, bottom_row = top_row;
    for (std::size_t next = 0; next < component.size(); ++next) {
      const int pixel = component[next], row = pixel / columns, column = pixel % columns;
      points += image.returns()[pixel];
      top_row = std::min(top_row, row);
      bottom_row = std::max(bottom_row, row);
      const auto visit = [&](int neighbour, double apart_deg) {
        if (seen[neighbour] || !isObstacle(neighbour) || !connected(pixel, neighbour, apart_deg)) return;
        seen[neighbour] = true;
        component.push_back(neighbour);
      };
      visit(row * columns + (column + 1) % columns, 360.0 / columns);
      visit(row * columns + (column + columns - 1) % columns, 360.0 / columns);
      if (row > 0) visit(pixel - columns, sensor.elevations_deg[row - 1] - sensor.elevations_deg[row]);
      if (row + 1 < sensor.rows()) visit(pixel + columns, sensor.elevations_deg[row] - sensor.elevations_deg[row + 1]);
    }
    const bool kept = points >= 30 || (points >= 5 && bottom_row - top_row + 1 >= 3);
    ++(kept ? large : small);
    for (const int pixel : component) {
      ASSERT_EQ(segmenter.stages().pixel_labels[pixel], kept ? StructuralLabel::NON_GROUND : StructuralLabel::NOISE)
          << pixel;
    }
  }
  EXPECT_GT(large, 100);
  EXPECT_GT(small, 100);
}

INSTANTIATE_TEST_SUITE_P(ScanSegmenter, BothRules, ::testing::Values(GroundRule::INCLINATION, GroundRule::GROWING),
                         [](const ::testing::TestParamInfo<GroundRule>& tested) {
                           return tested.param == GroundRule::GROWING ? "Growing" : "Inclination";
                         });

// Labels of a wall of the given rows and columns, alone in the sky.
std::vector<StructuralLabel> labelsOfPatch(int first_row, int rows, int first_column, int columns) {
  const SensorModel sensor = testSensor();
  const auto scan = organizedScan(sensor, [&](int row, int column) {
    const int shifted = (column - first_column + sensor.columns) % sensor.columns;
    return row >= first_row && row < first_row + rows && shifted < columns ? 10.0 : kNoReturn;
  });
  SegmentationOptions options = testOptions(GroundRule::INCLINATION);
  ScanSegmenter segmenter(options);
  std::vector<StructuralLabel> labels;
  segmenter.segment(viewOf(scan), labels);
  return labels;
}

std::ptrdiff_t nonGround(const std::vector<StructuralLabel>& labels) {
  return std::count(labels.begin(), labels.end(), StructuralLabel::NON_GROUND);
}

TEST(ComponentFilter, SizeAndRingsDecide) {
  EXPECT_EQ(nonGround(labelsOfPatch(1, 1, 10, 29)), 0);
  EXPECT_EQ(nonGround(labelsOfPatch(1, 1, 10, 30)), 30);
  EXPECT_EQ(nonGround(labelsOfPatch(1, 2, 10, 14)), 0);
  EXPECT_EQ(nonGround(labelsOfPatch(1, 2, 10, 15)), 30);
  EXPECT_EQ(nonGround(labelsOfPatch(1, 4, 10, 1)), 0);
  EXPECT_EQ(nonGround(labelsOfPatch(1, 5, 10, 1)), 5);
  EXPECT_EQ(nonGround(labelsOfPatch(1, 3, 10, 2)), 6);
}

TEST(ComponentFilter, ComponentsGoOnOverTheSeam) {
  EXPECT_EQ(nonGround(labelsOfPatch(1, 1, 700, 40)), 40);  // 20 pixels either side
  EXPECT_EQ(nonGround(labelsOfPatch(1, 1, 710, 29)), 0);
}

TEST(ComponentFilter, AStepInRangeSeparates) {
  const SensorModel sensor = testSensor();
  const auto scan = organizedScan(sensor, [](int row, int column) {
    if (row != 2 || column < 10 || column >= 50) return kNoReturn;
    return column < 30 ? 10.0 : 11.0;
  });
  ScanSegmenter segmenter(testOptions(GroundRule::GROWING));
  std::vector<StructuralLabel> labels;
  segmenter.segment(viewOf(scan), labels);
  EXPECT_EQ(nonGround(labels), 0);
}

TEST(SegmentationOptions, NamesTheFieldThatIsWrong) {
  const auto expectNamed = [](const SegmentationOptions& options, const std::string& field) {
    try {
      ScanSegmenter segmenter(options);
      FAIL() << field;
    } catch (const std::invalid_argument& error) {
      EXPECT_EQ(std::string(error.what()).rfind(field, 0), 0U) << error.what();
    }
  };
  SegmentationOptions options;
  options.mounting_pitch_deg = 91.0;
  expectNamed(options, "mounting_pitch_deg");
  options = SegmentationOptions();
  options.ground.step_tolerance_m = -1.0;
  expectNamed(options, "step_tolerance_m");
  options = SegmentationOptions();
  options.ground.foot_angle_deg = 90.5;
  expectNamed(options, "foot_angle_deg");
  options = SegmentationOptions();
  options.ground.foot_height_m = -0.1;
  expectNamed(options, "foot_height_m");
  options = SegmentationOptions();
  options.components.min_points = 0;
  expectNamed(options, "min_points");
  options = SegmentationOptions();
  options.ground.inclination_limit_deg = std::numeric_limits<double>::quiet_NaN();
  expectNamed(options, "inclination_limit_deg");
}

}  // namespace
}  // namespace saw_ndt
