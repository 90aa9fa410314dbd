#include "localization/source_voxel_filter.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <tuple>

#include "common/instruction_set.h"
#include "expect_throws.h"

namespace saw_ndt {

using namespace internal;

namespace {

struct Point {
  Eigen::Vector3f position;
  StructuralLabel label;
};

std::vector<Point> randomPoints(unsigned seed, int count, float extent_m) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> anywhere(-extent_m, extent_m);
  std::vector<Point> points;
  for (int i = 0; i < count; ++i) {
    points.push_back({{anywhere(random), anywhere(random), 0.2F * anywhere(random)},
                      static_cast<StructuralLabel>(random() % kStructuralLabelCount)});
  }
  return points;
}

struct Scan {
  std::vector<float> xyz;
  std::vector<StructuralLabel> labels;

  explicit Scan(const std::vector<Point>& points) {
    for (const Point& point : points) {
      xyz.insert(xyz.end(), point.position.data(), point.position.data() + 3);
      labels.push_back(point.label);
    }
  }
  ScanView view() const {
    ScanView view;
    view.xyz = xyz.data();
    view.stride = 3;
    view.size = labels.size();
    return view;
  }
};

SourcePoints filtered(SourceVoxelFilter& filter, const std::vector<Point>& points,
                      const SourceSelection& selection = SourceSelection()) {
  const Scan scan(points);
  return filter.filter(scan.view(), &scan.labels, selection);
}

SourcePoints filteredWithoutLabels(SourceVoxelFilter& filter, const std::vector<Point>& points) {
  return filter.filter(Scan(points).view(), nullptr);
}

bool sameBits(const SourcePoints& a, const SourcePoints& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z && a.label == b.label && a.labelled == b.labelled;
}

/// Compares with a plain map in double precision; centroids must come in the order of their first points.
void expectCentroids(const std::vector<Point>& points, double voxel_size_m, double tolerance_m) {
  using Key = std::tuple<int, int, int, StructuralLabel>;
  std::map<Key, std::pair<Eigen::Vector3d, int>> sums;
  std::vector<Key> order;
  for (const Point& point : points) {
    // The voxel is that of the single-precision quotient: a point on a boundary may go either way.
    const auto inverse = static_cast<float>(1.0 / voxel_size_m);
    std::array<int, 3> voxel{};
    for (int axis = 0; axis < 3; ++axis) voxel[axis] = static_cast<int>(std::floor(point.position[axis] * inverse));
    const Key key{voxel[0], voxel[1], voxel[2], point.label};
    const auto [entry, is_new] = sums.try_emplace(key, Eigen::Vector3d::Zero(), 0);
    if (is_new) order.push_back(key);
    entry->second.first += point.position.cast<double>();
    ++entry->second.second;
  }
  SourceVoxelFilter filter(voxel_size_m);
  const SourcePoints source = filtered(filter, points);
  ASSERT_EQ(source.size(), order.size());
  EXPECT_TRUE(source.labelled);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const auto& [sum, count] = sums.at(order[i]);
    const Eigen::Vector3d centroid(source.x[i], source.y[i], source.z[i]);
    ASSERT_LT((centroid - sum / count).cwiseAbs().maxCoeff(), tolerance_m) << i;
    ASSERT_EQ(source.label[i], static_cast<std::uint8_t>(std::get<3>(order[i]))) << i;
  }
}

TEST(SourceVoxelFilter, IsTheCentroidOfEachVoxelAndLabel) {
  expectCentroids(randomPoints(1, 20000, 4.0F), 0.2, 1e-6);
  expectCentroids(randomPoints(2, 20000, 80.0F), 1.0, 2e-5);
  expectCentroids(randomPoints(3, 5000, 0.05F), 0.2, 1e-7);
  expectCentroids(randomPoints(4, 20000, 80.0F), 0.013, 2e-5);
}

TEST(SourceVoxelFilter, GrowsBeyondItsFirstTable) {
  expectCentroids(randomPoints(5, 150000, 100.0F), 0.2, 2e-5);
  // Growing keeps what an object was given; a later, smaller source is as from a new one.
  SourceVoxelFilter filter(0.2), fresh(0.2);
  filtered(filter, randomPoints(5, 150000, 100.0F));
  const std::vector<Point> few = randomPoints(6, 1000, 3.0F);
  EXPECT_TRUE(sameBits(filtered(filter, few), filtered(fresh, few)));
}

TEST(SourceVoxelFilter, LabelsOfOneVoxelStayApart) {
  SourceVoxelFilter filter(1.0);
  const SourcePoints source = filtered(filter, {{{0.2F, 0.2F, 0.2F}, StructuralLabel::NON_GROUND},
                                                {{0.4F, 0.4F, 0.4F}, StructuralLabel::GROUND},
                                                {{0.6F, 0.2F, 0.2F}, StructuralLabel::NON_GROUND},
                                                {{0.8F, 0.8F, 0.8F}, StructuralLabel::NOISE}});
  EXPECT_EQ(source.label, (std::vector<std::uint8_t>{2, 1, 0}));
  EXPECT_FLOAT_EQ(source.x[0], 0.4F);
  EXPECT_FLOAT_EQ(source.x[1], 0.4F);
  EXPECT_FLOAT_EQ(source.x[2], 0.8F);
}

TEST(SourceVoxelFilter, ZeroIsNotInsideBothItsNeighbours) {
  SourceVoxelFilter filter(1.0);
  const SourcePoints source = filtered(filter, {{{-0.25F, -0.25F, -0.25F}, StructuralLabel::GROUND},
                                                {{0.25F, 0.25F, 0.25F}, StructuralLabel::GROUND},
                                                {{-0.75F, -0.25F, -0.25F}, StructuralLabel::GROUND}});
  ASSERT_EQ(source.size(), 2U);
  EXPECT_FLOAT_EQ(source.x[0], -0.5F);
  EXPECT_FLOAT_EQ(source.y[0], -0.25F);
  EXPECT_FLOAT_EQ(source.x[1], 0.25F);
}

TEST(SourceVoxelFilter, SizeZeroKeepsThePoints) {
  const std::vector<Point> points = randomPoints(7, 500, 0.1F);
  SourceVoxelFilter filter(0.0);
  for (const bool labelled : {true, false}) {
    const SourcePoints source = labelled ? filtered(filter, points) : filteredWithoutLabels(filter, points);
    ASSERT_EQ(source.size(), points.size());
    EXPECT_EQ(source.labelled, labelled);
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_EQ(Eigen::Vector3f(source.x[i], source.y[i], source.z[i]), points[i].position);
      const StructuralLabel label = labelled ? points[i].label : StructuralLabel::NON_GROUND;
      EXPECT_EQ(source.label[i], static_cast<std::uint8_t>(label));
    }
  }
}

TEST(SourceVoxelFilter, PassesOverWhatIsNotFiniteOrTooFar) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  for (const double voxel_size_m : {0.2, 0.0}) {
    std::vector<float> bad = {nan, infinity, -infinity};
    if (voxel_size_m > 0.0) bad.insert(bad.end(), {104858.0F, -104858.0F, 5e8F, -5e8F, 3e38F, -3e38F});
    std::vector<Point> points;
    for (const float value : bad) {
      for (int axes = 1; axes < 8; ++axes) {
        Eigen::Vector3f point(1.0F, 2.0F, 3.0F);
        for (int axis = 0; axis < 3; ++axis) {
          if ((axes >> axis & 1) != 0) point[axis] = value;
        }
        points.push_back({point, StructuralLabel::GROUND});
      }
    }
    points.push_back({{1.0F, 2.0F, 3.0F}, StructuralLabel::GROUND});
    SourceVoxelFilter filter(voxel_size_m);
    const SourcePoints source = filtered(filter, points);
    ASSERT_EQ(source.size(), 1U) << voxel_size_m;
    EXPECT_FLOAT_EQ(source.z[0], 3.0F);
  }
}

TEST(SourceVoxelFilter, AnObjectUsedAgainGivesTheSameBits) {
  const std::vector<Point> first = randomPoints(8, 5000, 5.0F), second = randomPoints(9, 3000, 9.0F);
  SourceVoxelFilter filter(0.2);
  const SourcePoints expected = filtered(filter, first);
  filteredWithoutLabels(filter, second);
  EXPECT_TRUE(filtered(filter, {}).empty());
  EXPECT_TRUE(sameBits(filtered(filter, first), expected));
}

TEST(SourceVoxelFilter, FarVoxelsAreApart) {
  // The farthest voxels along each axis, and those beside them.
  std::vector<Point> points;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float place : {524287.5F, 524286.5F, -524286.5F, -524285.5F, 0.5F}) {
      Eigen::Vector3f point(0.5F, 0.5F, 0.5F);
      point[axis] = place;
      points.push_back({point, StructuralLabel::NOISE});
    }
  }
  SourceVoxelFilter filter(1.0);
  const SourcePoints source = filtered(filter, points);
  ASSERT_EQ(source.size(), 13U);  // that in the middle is met thrice
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(source.x[i], points[i].position.x());
  EXPECT_EQ(source.z[12], points[13].position.z());
}

TEST(SourceVoxelFilter, TakesWhatIsSelectedIntoTheBaseFrame) {
  const std::vector<Point> points = randomPoints(10, 5000, 6.0F);
  SourceSelection selection;
  selection.ground_ratio = 0.37;
  selection.confidence = ConfidenceOptions::paper();
  selection.T_base_lidar.rotate(Eigen::AngleAxisd(0.4, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()));
  selection.T_base_lidar.translation() << 1.2, -0.3, 1.9;
  std::vector<Point> selected;
  GroundSampler sampler({selection.ground_ratio});
  for (const Point& point : points) {
    if (point.label == StructuralLabel::NOISE) continue;
    if (point.label == StructuralLabel::GROUND && !sampler.keepsNext()) continue;
    selected.push_back({selection.T_base_lidar.cast<float>() * point.position, point.label});
  }
  for (const double voxel_size_m : {0.2, 0.0}) {
    SourceVoxelFilter filter(voxel_size_m), reference(voxel_size_m);
    const SourcePoints source = filtered(filter, points, selection);
    EXPECT_GT(source.size(), 1000U);
    EXPECT_TRUE(sameBits(source, filtered(reference, selected)));
  }
}

TEST(SourceVoxelFilter, EveryInstructionSetGivesTheSameBits) {
  std::vector<Point> points = randomPoints(11, 3001, 7.0F);
  points[5].position.y() = std::numeric_limits<float>::quiet_NaN();
  SourceSelection selection;
  selection.ground_ratio = 0.5;
  selection.T_base_lidar.rotate(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitY()));
  SourceVoxelFilter filter(0.2);
  const SourcePoints expected = filtered(filter, points, selection);
  for (const InstructionSet set :
       {InstructionSet::BASELINE, InstructionSet::SSE4, InstructionSet::AVX2, InstructionSet::AVX512}) {
    limitInstructionSet(set);
    EXPECT_TRUE(sameBits(filtered(filter, points, selection), expected)) << toString(set);
  }
}

TEST(SourceVoxelFilter, RefusesLabelsOfAnotherScan) {
  const Scan scan(randomPoints(12, 10, 1.0F));
  const std::vector<StructuralLabel> few(9, StructuralLabel::GROUND);
  SourceVoxelFilter filter(0.2);
  expectThrows<std::invalid_argument>([&] { filter.filter(scan.view(), &few); }, {"labels: 9 for 10 points"});
  SourceSelection selection;
  selection.ground_ratio = 1.5;
  expectThrows<std::invalid_argument>([&] { filter.filter(scan.view(), nullptr, selection); }, {"ground_ratio = 1.5"});
}

TEST(SourceVoxelFilter, RefusesSizesThatAreNone) {
  for (const double value : {-0.1, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    expectThrows<std::invalid_argument>([&] { SourceVoxelFilter{value}; }, {"source_voxel_size_m = "});
  }
}

}  // namespace
}  // namespace saw_ndt
