#include "saw_ndt/map/voxel_sums.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

namespace saw_ndt {
namespace {

using Steps = std::array<std::int32_t, 3>;

constexpr std::int32_t kHalf = kStepsPerVoxel / 2;

QuantizedPosition quantized(double x, double y, double z, double inverse_resolution = 1.0) {
  QuantizedPosition position{};
  EXPECT_TRUE(quantize({x, y, z}, inverse_resolution, position));
  return position;
}

std::vector<Steps> randomSteps(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<std::int32_t> anywhere(-kHalf, kHalf);
  std::vector<Steps> points(count);
  for (Steps& point : points) point = {anywhere(random), anywhere(random), anywhere(random)};
  return points;
}

VoxelSums sumsOf(const std::vector<Steps>& points) {
  VoxelSums sums;
  for (const Steps& point : points) sums.add(point);
  return sums;
}

TEST(Quantize, VoxelAndStepsOfKnownPositions) {
  // The centre of voxel 2, the middle of the upper half of voxel -1, a quarter into voxel -3.
  const QuantizedPosition position = quantized(2.5, -0.25, -2.75);
  EXPECT_EQ(position.voxel, VoxelCoordinate(2, -1, -3));
  EXPECT_EQ(position.steps, (Steps{0, kHalf / 2, -kHalf / 2}));
  // The same at 0.5 m voxels: 2.5 / 0.5 = 5.0 is the lower face of voxel 5; -0.25 / 0.5 = -0.5; -2.75 / 0.5 = -5.5.
  const QuantizedPosition fine = quantized(2.5, -0.25, -2.75, 2.0);
  EXPECT_EQ(fine.voxel, VoxelCoordinate(5, -1, -6));
  EXPECT_EQ(fine.steps, (Steps{-kHalf, 0, 0}));
}

TEST(Quantize, AFaceBelongsToTheVoxelAboveIt) {
  const QuantizedPosition position = quantized(3.0, -3.0, 0.0);
  EXPECT_EQ(position.voxel, VoxelCoordinate(3, -3, 0));
  EXPECT_EQ(position.steps, (Steps{-kHalf, -kHalf, -kHalf}));
  // Just below a face; -1e-300 is lost when 1 is added to it, and rounds to the face of its own voxel.
  const QuantizedPosition below = quantized(std::nextafter(3.0, 0.0), -1e-300, -0.0);
  EXPECT_EQ(below.voxel, VoxelCoordinate(2, -1, 0));
  EXPECT_EQ(below.steps, (Steps{kHalf, kHalf, -kHalf}));
}

TEST(Quantize, RoundsByHalfAStepAtMost) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> anywhere(-300.0, 300.0);
  for (const double resolution_m : {0.3, 1.0, 2.5}) {
    const double step_m = resolution_m / kStepsPerVoxel;
    for (int i = 0; i < 20000; ++i) {
      const Eigen::Vector3d p(anywhere(random), anywhere(random), anywhere(random));
      const QuantizedPosition position = quantized(p.x(), p.y(), p.z(), 1.0 / resolution_m);
      for (int axis = 0; axis < 3; ++axis) {
        const std::int32_t steps = position.steps[static_cast<std::size_t>(axis)];
        ASSERT_LE(std::abs(steps), kHalf);
        const double restored = (position.voxel[axis] + 0.5) * resolution_m + steps * step_m;
        ASSERT_NEAR(restored, p[axis], 0.5 * step_m + 1e-12);
      }
    }
  }
}

TEST(Quantize, RefusesWhatHasNoVoxel) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  QuantizedPosition position;
  for (const double bad : {kNan, kInfinity, -kInfinity, 3e9, -3e9, 1e300, 2147483648.0}) {
    for (int axis = 0; axis < 3; ++axis) {
      Eigen::Vector3d p(1.0, 2.0, 3.0);
      p[axis] = bad;
      EXPECT_FALSE(quantize(p, 1.0, position)) << bad;
    }
  }
  EXPECT_FALSE(quantize({3e6, 0.0, 0.0}, 1000.0, position));
  EXPECT_TRUE(quantize({2147482999.0, -2147482999.5, 0.0}, 1.0, position));
  EXPECT_EQ(position.voxel, VoxelCoordinate(2147482999, -2147483000, 0));
}

TEST(VoxelSums, AddsByHand) {
  VoxelSums sums;
  sums.add({1, -2, 3});
  sums.add({-4, 5, 6});
  EXPECT_EQ(sums.count, 2U);
  EXPECT_EQ(sums.sum, (std::array<std::int64_t, 3>{-3, 3, 9}));
  // xx 1+16, xy -2-20, xz 3-24, yy 4+25, yz -6+30, zz 9+36
  EXPECT_EQ(sums.product, (std::array<std::int64_t, 6>{17, -22, -21, 29, 24, 45}));
}

TEST(VoxelSums, AnyOrderAndPartitionGiveEqualSums) {
  std::vector<Steps> points = randomSteps(5000, 1);
  const VoxelSums expected = sumsOf(points);
  std::mt19937 random(2);
  for (int trial = 0; trial < 20; ++trial) {
    std::shuffle(points.begin(), points.end(), random);
    EXPECT_EQ(sumsOf(points), expected);
    std::vector<VoxelSums> parts(7);
    for (const Steps& point : points) parts[random() % parts.size()].add(point);
    std::shuffle(parts.begin(), parts.end(), random);
    VoxelSums left_to_right;
    for (const VoxelSums& part : parts) left_to_right += part;
    EXPECT_EQ(left_to_right, expected);
    while (parts.size() > 1) {
      const VoxelSums last = parts.back();
      parts.pop_back();
      parts[random() % parts.size()] += last;
    }
    EXPECT_EQ(parts.front(), expected);
  }
}

TEST(VoxelSums, HoldManyPointsInACorner) {
  // 2^33 - 1 points at the corner: products of 2^30 each stay below 2^63.
  VoxelSums sums;
  sums.add({kHalf, -kHalf, kHalf});
  VoxelSums total = sums;
  for (int doubling = 0; doubling < 32; ++doubling) {
    const VoxelSums half = total;
    total += half;
    total += sums;
  }
  EXPECT_EQ(total.count, (std::uint64_t{1} << 33) - 1);
  const auto count = static_cast<std::int64_t>(total.count);
  EXPECT_EQ(total.sum[1], -count * kHalf);
  EXPECT_EQ(total.product[0], count * (std::int64_t{1} << 30));
  EXPECT_EQ(total.product[1], -count * (std::int64_t{1} << 30));
}

TEST(VoxelSums, ShiftedAgreesWithShiftingEveryPoint) {
  const std::vector<Steps> points = randomSteps(300, 4);
  for (const std::array<std::int64_t, 3>& shift :
       {std::array<std::int64_t, 3>{0, 0, 0}, {1, -1, 7}, {65536, -65536, 32768}, {-98304, 0, 12345}}) {
    VoxelSums expected;
    for (const Steps& point : points) {
      Steps moved;
      for (std::size_t i = 0; i < 3; ++i) moved[i] = point[i] + static_cast<std::int32_t>(shift[i]);
      expected.add(moved);
    }
    EXPECT_EQ(sumsOf(points).shifted(shift), expected);
  }
  EXPECT_EQ(VoxelSums().shifted({5, 6, 7}), VoxelSums());
}

TEST(VoxelSums, ShiftingThereAndBackChangesNothing) {
  const VoxelSums sums = sumsOf(randomSteps(100, 5));
  EXPECT_EQ(sums.shifted({70000, -3, 99}).shifted({-70000, 3, -99}), sums);
}

}  // namespace
}  // namespace saw_ndt
