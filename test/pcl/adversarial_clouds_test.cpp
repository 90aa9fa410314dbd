#include "adversarial_clouds.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <string>
#include <vector>

#include "saw_ndt/pcl/cloud_view.h"
#include "saw_ndt/pcl/range_image_segmentation.h"
#include "saw_ndt/pcl/weighted_normal_distributions_transform.h"

namespace saw_ndt {
namespace {

using Plain = pcl::PointCloud<pcl::PointXYZ>;
using Labelled = pcl::PointCloud<pcl::PointXYZL>;

// A pose may be off by as much beside what its covariance says (m, at kRotationArm_m for rotations).
constexpr double kSigma_m = 0.03;
// The squared Mahalanobis distance that chance passes once in a thousand times, of six numbers.
constexpr double kUnlikely = 22.5;

Plain::Ptr plain(const std::vector<LidarPoint>& points) {
  auto cloud = pcl::make_shared<Plain>();
  for (const LidarPoint& point : points) cloud->push_back({point.x, point.y, point.z});
  cloud->is_dense = false;
  return cloud;
}

/// With labels of every kind.
Labelled::Ptr labelled(const std::vector<LidarPoint>& points) {
  auto cloud = pcl::make_shared<Labelled>();
  std::uint32_t next = 0;
  for (const LidarPoint& point : points) {
    pcl::PointXYZL& added = cloud->emplace_back();
    added.getVector3fMap() = positionOf(point);
    added.label = point.z < -1.5F ? 1 : 1 + ++next % 8 / 2 % 2;
  }
  cloud->is_dense = false;
  return cloud;
}

Eigen::Matrix4f nearGuess() {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << 0.2, -0.1, 0.05;
  T.linear() = rotationFromVector({0.0, 0.0, 0.01});
  return T.matrix().cast<float>();
}

/// The squared Mahalanobis distance of a pose from the identity.
double unlikelihoodOf(const AlignmentResult& result) {
  Vector6d off, sigma;
  off << result.T_map_source * result.rotation_centre - result.rotation_centre,
      rotationVector(result.T_map_source.linear());
  sigma << Eigen::Vector3d::Constant(kSigma_m), Eigen::Vector3d::Constant(kSigma_m / kRotationArm_m);
  const Matrix6d covariance = result.covariance + Matrix6d(sigma.cwiseAbs2().asDiagonal());
  return off.dot(covariance.ldlt().solve(off));
}

void expectDefined(const AlignmentResult& result) {
  EXPECT_TRUE(result.T_map_source.matrix().allFinite());
  const Eigen::Matrix3d R = result.T_map_source.linear();
  EXPECT_TRUE(R.isUnitary(1e-6)) << R;
  EXPECT_GT(R.determinant(), 0.0);
  EXPECT_TRUE(std::isfinite(result.score)) << result.score;
  EXPECT_TRUE(std::isfinite(result.likelihood)) << result.likelihood;
  EXPECT_TRUE(result.information.allFinite()) << result.information;
  EXPECT_TRUE(result.covariance.allFinite()) << result.covariance;
  EXPECT_GE(result.overlap, 0.0);
  EXPECT_LE(result.overlap, 1.0);
}

/// @return the registration object, after it has aligned
template <typename PointT>
AlignmentResult aligned(const typename pcl::PointCloud<PointT>::Ptr& source,
                        const typename pcl::PointCloud<PointT>::Ptr& target, Optimizer optimizer) {
  WeightedNormalDistributionsTransform<PointT, PointT> ndt;
  ndt.setOptimizer(optimizer);
  if (optimizer == Optimizer::NEWTON_MORE_THUENTE) ndt.setTransformationEpsilon(1e-6);
  ndt.setInputTarget(target);
  ndt.setInputSource(source);
  pcl::PointCloud<PointT> output;
  ndt.align(output, nearGuess());
  EXPECT_EQ(output.size(), source->size());
  EXPECT_EQ(ndt.hasConverged(), ndt.getAlignmentResult().converged());
  EXPECT_TRUE(ndt.getFinalTransformation().allFinite());
  expectDefined(ndt.getAlignmentResult());
  EXPECT_GE(ndt.getFitnessScore(), 0.0);
  return ndt.getAlignmentResult();
}

bool isTheStreet(const AdversarialCloud& cloud) {
  const std::string name = cloud.name;
  return name == "Twice" || name == "Shuffled" || name == "AmongGarbage";
}

TEST(AdversarialClouds, AreSegmentedByAFilter) {
  RangeImageSegmentation<pcl::PointXYZ> filter(true);
  SegmentationOptions options;
  options.sensor = SensorModel::named("VLP-16");
  filter.setOptions(options);
  forEveryAdversarialCloud([&](const std::vector<LidarPoint>& points) {
    filter.setInputCloud(plain(points));
    Plain kept;
    filter.filter(kept);
    EXPECT_EQ(kept.size() + filter.getRemovedIndices()->size(), points.size());
    for (const pcl::PointXYZ& point : kept) ASSERT_TRUE(pcl::isFinite(point));
  });
}

class AlignedAdversarialClouds : public testing::TestWithParam<Optimizer> {};

TEST_P(AlignedAdversarialClouds, ToThemselvesAreWhereTheCovarianceSaysOrNotConverged) {
  forEveryAdversarialCloud([](const std::vector<LidarPoint>& points) {
    for (const bool labels : {false, true}) {
      const AlignmentResult result = labels ? aligned<pcl::PointXYZL>(labelled(points), labelled(points), GetParam())
                                            : aligned<pcl::PointXYZ>(plain(points), plain(points), GetParam());
      if (!result.converged()) continue;
      EXPECT_LT(unlikelihoodOf(result), kUnlikely) << result.T_map_source.matrix();
    }
  });
}

TEST_P(AlignedAdversarialClouds, ToAStreetConvergeWhereTheyAreOne) {
  const Plain::Ptr street = plain(streetScan(2));
  for (const AdversarialCloud& cloud : adversarialClouds()) {
    SCOPED_TRACE(cloud.name);
    const AlignmentResult result = aligned<pcl::PointXYZ>(plain(cloud.points()), street, GetParam());
    if (isTheStreet(cloud)) {
      EXPECT_TRUE(result.converged()) << toString(result.status) << " " << result.overlap;
      EXPECT_LT(unlikelihoodOf(result), kUnlikely);
    } else if (result.converged()) {
      // A line fits many places of a street, and is free to move in most directions.
      EXPECT_GE(result.free_directions.cols(), 3) << result.overlap;
    }
    aligned<pcl::PointXYZ>(street, plain(cloud.points()), GetParam());
  }
}

INSTANTIATE_TEST_SUITE_P(By, AlignedAdversarialClouds,
                         testing::Values(Optimizer::DAMPED_NEWTON, Optimizer::NEWTON_MORE_THUENTE),
                         [](const auto& of) { return std::string(of.index == 0 ? "DampedNewton" : "MoreThuente"); });

}  // namespace
}  // namespace saw_ndt
