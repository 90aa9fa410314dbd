#include "saw_ndt/map/voxel_statistics.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <random>
#include <vector>

#include "expect_throws.h"
#include "map_fixtures.h"

namespace saw_ndt {
namespace {

constexpr double kStepM = 1.0 / kStepsPerVoxel;  // in 1 m voxels

/// Six points a, b and c steps from the centre along x, y and z, on either side. Their sample covariance is diagonal:
/// 2 a^2 / 5, 2 b^2 / 5, 2 c^2 / 5 (N - 1 = 5), in square steps.
VoxelSums octahedron(std::int32_t a, std::int32_t b, std::int32_t c) {
  VoxelSums sums;
  for (const std::int32_t sign : {-1, 1}) {
    sums.add({sign * a, 0, 0});
    sums.add({0, sign * b, 0});
    sums.add({0, 0, sign * c});
  }
  return sums;
}

std::optional<VoxelStatistics> statisticsOf(const VoxelSums& sums, double mean_confidence = 1.0,
                                            const VoxelWeighting& weighting = {}) {
  return voxelStatistics({1, -2, 3}, sums, mean_confidence, weighting, kStepM);
}

TEST(VoxelStatistics, LinearVoxelByHand) {
  // 0.25, 0.0625 and 0.03125 m: sigma as 8 : 2 : 1, so f_L = 6/8, f_P = 1/8, f_V = 1/8: linear, alpha 0.75.
  // Mean confidence 0.8: weight 0.8 * 0.75 = 0.6. Variances 2/5 of 0.0625, 0.00390625 and 0.0009765625 m^2;
  // the smallest is 1/64 of the largest and stays.
  const auto voxel = statisticsOf(octahedron(16384, 4096, 2048), 0.8);
  ASSERT_TRUE(voxel);
  EXPECT_EQ(voxel->structure_class, StructureClass::LINEAR);
  EXPECT_DOUBLE_EQ(voxel->weight, 0.6);
  EXPECT_EQ(voxel->point_count, 6U);
  EXPECT_EQ(voxel->mean_from_centre, Eigen::Vector3d::Zero());
  EXPECT_EQ(voxel->mean(1.0), Eigen::Vector3d(1.5, -1.5, 3.5));
  EXPECT_TRUE(voxel->covariance.isApprox(Eigen::Vector3d(0.025, 0.0015625, 0.000390625).asDiagonal().toDenseMatrix()));
  EXPECT_TRUE(voxel->inverse_covariance.isApprox(Eigen::Vector3d(40.0, 640.0, 2560.0).asDiagonal().toDenseMatrix()));
}

TEST(VoxelStatistics, PlanarVoxelByHand) {
  // sigma as 8 : 6 : 1: f_L = 2/8, f_P = 5/8, f_V = 1/8: planar, alpha 1.25; 0.5 * 1.25 = 0.625.
  const auto voxel = statisticsOf(octahedron(2048, 16384, 12288), 0.5);
  ASSERT_TRUE(voxel);
  EXPECT_EQ(voxel->structure_class, StructureClass::PLANAR);
  EXPECT_DOUBLE_EQ(voxel->mean_confidence, 0.5);
  EXPECT_DOUBLE_EQ(voxel->weight, 0.625);
}

TEST(VoxelStatistics, VolumetricVoxelByHand) {
  // sigma as 8 : 7 : 6: f_L = 1/8, f_P = 1/8, f_V = 6/8: volumetric, alpha 1; 0.9 * 1 = 0.9.
  const auto voxel = statisticsOf(octahedron(14336, 12288, 16384), 0.9);
  ASSERT_TRUE(voxel);
  EXPECT_EQ(voxel->structure_class, StructureClass::VOLUMETRIC);
  EXPECT_DOUBLE_EQ(voxel->weight, 0.9);
}

TEST(VoxelStatistics, ClassOfRotatedPointsIsTheSame) {
  const Eigen::Matrix3d R = Eigen::Quaterniond(0.3, -0.5, 0.7, 0.2).normalized().toRotationMatrix();
  const struct {
    Eigen::Vector3d half_axes;
    StructureClass structure_class;
  } cases[] = {{{16000, 4000, 2000}, StructureClass::LINEAR},
               {{16000, 12000, 2000}, StructureClass::PLANAR},
               {{16000, 14000, 12000}, StructureClass::VOLUMETRIC}};
  for (const auto& c : cases) {
    VoxelSums sums;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double sign : {-1.0, 1.0}) {
        const Eigen::Vector3d point = R.col(axis) * (sign * c.half_axes[axis]);
        sums.add({static_cast<std::int32_t>(std::lround(point.x())), static_cast<std::int32_t>(std::lround(point.y())),
                  static_cast<std::int32_t>(std::lround(point.z()))});
      }
    }
    const auto voxel = statisticsOf(sums);
    ASSERT_TRUE(voxel);
    EXPECT_EQ(voxel->structure_class, c.structure_class);
    const Eigen::Vector3d variances = 0.4 * (c.half_axes * kStepM).cwiseAbs2();
    EXPECT_TRUE(voxel->covariance.isApprox(R * variances.asDiagonal() * R.transpose(), 1e-3));
  }
}

TEST(StructureClassOf, TiesGoToTheFirstOfTheThree) {
  EXPECT_EQ(structureClass({16.0, 4.0, 0.0}), StructureClass::LINEAR);  // f_L = f_P = 1/2
  EXPECT_EQ(structureClass({4.0, 1.0, 4.0}), StructureClass::PLANAR);   // f_P = f_V = 1/2
  EXPECT_EQ(structureClass({1.0, 1.0, 1.0}), StructureClass::VOLUMETRIC);
  EXPECT_EQ(structureClass({0.0, 1.0, 0.0}), StructureClass::LINEAR);
  EXPECT_EQ(structureClass({1.0, -1e-18, 1.0}), StructureClass::PLANAR);  // rounding of an exact plane
}

TEST(VoxelStatistics, SmallEigenvaluesAreRaisedAfterTheClassIsFound) {
  // sigma as 1 : 0.52 : 0.01. f_L = 0.48 and f_P = 0.51: planar. Were the smallest variance raised first, sigma_1 would
  // be 0.1 and f_P = 0.42: linear.
  const auto voxel = statisticsOf(octahedron(164, 16384, 8520));
  ASSERT_TRUE(voxel);
  EXPECT_EQ(voxel->structure_class, StructureClass::PLANAR);
  const double largest = 0.4 * 0.0625;
  EXPECT_NEAR(voxel->covariance(0, 0), 0.01 * largest, 1e-15);
  EXPECT_NEAR(voxel->covariance(1, 1), largest, 1e-15);
  EXPECT_NEAR(voxel->covariance(2, 2), 0.4 * std::pow(8520 * kStepM, 2), 1e-15);
  EXPECT_NEAR((voxel->covariance * voxel->inverse_covariance - Eigen::Matrix3d::Identity()).norm(), 0.0, 1e-12);
}

TEST(VoxelStatistics, PointsOnALineOrPlaneAreInvertible) {
  for (const VoxelSums& sums : {octahedron(10000, 0, 0), octahedron(0, 10000, 10000)}) {
    const auto voxel = statisticsOf(sums);
    ASSERT_TRUE(voxel);
    const double largest = 0.4 * std::pow(10000 * kStepM, 2);
    const Eigen::Vector3d eigenvalues = voxel->covariance.selfadjointView<Eigen::Upper>().eigenvalues();
    EXPECT_NEAR(eigenvalues[0], 0.01 * largest, 1e-15);
    EXPECT_NEAR(eigenvalues[2], largest, 1e-15);
    EXPECT_TRUE(voxel->inverse_covariance.allFinite());
  }
  VoxelWeighting weighting;
  weighting.min_eigenvalue_ratio = 0.25;
  EXPECT_NEAR(statisticsOf(octahedron(10000, 0, 0), 1.0, weighting)->covariance(2, 2),
              0.25 * 0.4 * std::pow(10000 * kStepM, 2), 1e-15);
}

TEST(VoxelStatistics, TooFewOrCoincidentPointsHaveNone) {
  VoxelSums sums;
  EXPECT_FALSE(statisticsOf(sums));
  for (std::int32_t i = 0; i < 5; ++i) {
    sums.add({1000 * i, -900 * i * i, 77});
    EXPECT_FALSE(statisticsOf(sums)) << sums.count;
  }
  VoxelWeighting three;
  three.min_points_per_voxel = 3;
  EXPECT_TRUE(statisticsOf(sums, 1.0, three));
  sums.add({0, 0, 0});
  EXPECT_TRUE(statisticsOf(sums));

  VoxelSums coincident;
  for (int i = 0; i < 1000; ++i) coincident.add({12345, -32768, 32767});
  EXPECT_FALSE(statisticsOf(coincident));
}

TEST(VoxelStatistics, AgreeWithDoublesToTheStatedRounding) {
  std::mt19937 random(8);
  const double half_step_m = 0.5 * kStepM;
  for (int trial = 0; trial < 200; ++trial) {
    std::uniform_real_distribution<double> spread(0.0, 0.5), unit(-1.0, 1.0);
    const Eigen::Vector3d scale(spread(random), spread(random), spread(random));
    const int count = 6 + static_cast<int>(random() % 200);
    std::vector<Eigen::Vector3d> points;
    VoxelSums sums;
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector3d p = Eigen::Vector3d(-4.5, 7.5, 0.5) +
                                scale.cwiseProduct(Eigen::Vector3d(unit(random), unit(random), unit(random)));
      points.push_back(p);
      QuantizedPosition position;
      ASSERT_TRUE(quantize(p, 1.0, position));
      ASSERT_EQ(position.voxel, VoxelCoordinate(-5, 7, 0));
      sums.add(position.steps);
    }
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& p : points) mean += p / count;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const Eigen::Vector3d& p : points) covariance += (p - mean) * (p - mean).transpose() / (count - 1);

    VoxelWeighting weighting;
    weighting.min_eigenvalue_ratio = 1e-12;  // so that the covariance is the sample's own
    const auto voxel = voxelStatistics({-5, 7, 0}, sums, 1.0, weighting, kStepM);
    ASSERT_TRUE(voxel);
    EXPECT_LE((voxel->mean(1.0) - mean).cwiseAbs().maxCoeff(), half_step_m * (1.0 + 1e-9));
    // Rounding moves a point by h and the mean by h at most, so a deviation d by 2 h. Then by Cauchy-Schwarz
    // |change of cov(i, j)| <= 2 h k (sigma_i + sigma_j) + 4 h^2 k^2, with k^2 = N / (N - 1).
    const double k = std::sqrt(count / (count - 1.0));
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        const double sigmas = std::sqrt(covariance(i, i)) + std::sqrt(covariance(j, j));
        EXPECT_LE(std::abs(voxel->covariance(i, j) - covariance(i, j)),
                  2.0 * half_step_m * k * sigmas + 4.0 * half_step_m * half_step_m * k * k + 1e-12);
      }
    }
  }
}

TEST(VoxelWeights, MeanConfidenceOfMixedLabelsByHand) {
  // One voxel of 12 points on the plane z = 0.5, 2 of them ground, 6 non-ground and 4 noise.
  pcl::PointCloud<pcl::PointXYZL> cloud;
  for (int i = 0; i < 12; ++i) {
    pcl::PointXYZL point;
    point.getVector3fMap() << 0.2F + 0.2F * static_cast<float>(i % 4), 0.2F + 0.3F * static_cast<float>(i / 4), 0.5F;
    point.label = i < 2 ? 1 : i < 8 ? 2 : 0;
    cloud.push_back(point);
  }
  const auto voxelWith = [&](const ConfidenceOptions& confidence) {
    VoxelWeighting weighting;
    weighting.confidence = confidence;
    const std::vector<VoxelStatistics> voxels = mapOf(cloud, 1.0).statistics(weighting);
    EXPECT_EQ(voxels.size(), 1U);
    return voxels.at(0);
  };
  // Default: (2 * 0.65 + 6 * 1 + 4 * 0.85) / 12 = 10.7 / 12. Planar: sigma_x^2 : sigma_y^2 is 0.6 : 0.72 (sums of
  // squares 3 * 2 * (0.3^2 + 0.1^2) and 8 * 0.3^2), f_L = 1 - sqrt(0.6 / 0.72) = 0.09.
  EXPECT_EQ(voxelWith(ConfidenceOptions()).structure_class, StructureClass::PLANAR);
  EXPECT_EQ(voxelWith(ConfidenceOptions()).point_count, 12U);
  EXPECT_DOUBLE_EQ(voxelWith(ConfidenceOptions()).mean_confidence, 10.7 / 12.0);
  EXPECT_DOUBLE_EQ(voxelWith(ConfidenceOptions()).weight, 10.7 / 12.0 * 1.25);
  // The paper's: noise takes no part, neither in the mean confidence, (2 * 0.5 + 6 * 1) / 8, nor in the count. The
  // rows y = 0.2 and 0.5 are left: sums of squares 2 * 2 * (0.3^2 + 0.1^2) = 0.4 and 8 * 0.15^2 = 0.18,
  // f_L = 1 - sqrt(0.18 / 0.4) = 0.33 and f_P = 0.67.
  const VoxelStatistics paper = voxelWith(ConfidenceOptions::paper());
  EXPECT_EQ(paper.point_count, 8U);
  EXPECT_DOUBLE_EQ(paper.mean_confidence, 7.0 / 8.0);
  EXPECT_DOUBLE_EQ(paper.weight, 7.0 / 8.0 * 1.25);
  EXPECT_NEAR(paper.mean(1.0).y(), 0.35, 1e-5);
  EXPECT_DOUBLE_EQ(voxelWith(ConfidenceOptions::uniform()).weight, 1.25);
}

TEST(VoxelWeighting, NamesTheFieldThatDoesNotHold) {
  const auto expectRefused = [](void (*spoil)(VoxelWeighting&), const std::string& name) {
    VoxelWeighting weighting;
    spoil(weighting);
    expectThrows<std::invalid_argument>([&] { weighting.check(); }, {name});
  };
  EXPECT_NO_THROW(VoxelWeighting().check());
  expectRefused([](VoxelWeighting& w) { w.confidence.noise = -0.1; }, "confidence.noise = -0.1");
  expectRefused([](VoxelWeighting& w) { w.confidence.ground = 1.5; }, "confidence.ground = 1.5");
  expectRefused([](VoxelWeighting& w) { w.confidence.non_ground = std::nan(""); }, "confidence.non_ground");
  expectRefused([](VoxelWeighting& w) { w.linear_alpha = 0.0; }, "linear_alpha = 0");
  expectRefused([](VoxelWeighting& w) { w.planar_alpha = -1.0; }, "planar_alpha = -1");
  expectRefused([](VoxelWeighting& w) { w.volumetric_alpha = 1.0 / 0.0; }, "volumetric_alpha = inf");
  expectRefused([](VoxelWeighting& w) { w.min_points_per_voxel = 2; }, "min_points_per_voxel = 2");
  expectRefused([](VoxelWeighting& w) { w.min_eigenvalue_ratio = 0.0; }, "min_eigenvalue_ratio = 0");
  expectRefused([](VoxelWeighting& w) { w.sizes.finest_m = -0.5; }, "sizes.finest_m = -0.5");
  expectRefused([](VoxelWeighting& w) { w.sizes.coarsest_m = std::nan(""); }, "sizes.coarsest_m");
  expectRefused([](VoxelWeighting& w) { w.sizes.min_scans = -1; }, "sizes.min_scans = -1");
  expectRefused([](VoxelWeighting& w) { w.sizes.min_spread = 0.5; }, "sizes.min_spread = 0.5");
  expectRefused([](VoxelWeighting& w) { w.coarse_factor = 0; }, "coarse_factor = 0");
}

}  // namespace
}  // namespace saw_ndt
