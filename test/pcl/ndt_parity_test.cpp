// The score, its derivatives and the poses that they lead to, against pcl::NormalDistributionsTransform itself.

#include <gtest/gtest.h>
#include <pcl/common/transforms.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/registration/ndt.h>

#include <iostream>

#include "real_data.h"
#include "registration/ndt_derivatives.h"
#include "registration/ndt_objective.h"
#include "registration/registration_fixtures.h"
#include "saw_ndt/drives/kitti_sequence.h"
#include "saw_ndt/pcl/weighted_normal_distributions_transform.h"

namespace saw_ndt {

using namespace internal;

namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

class PclNdt : public pcl::NormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ> {
 public:
  // Score and derivatives of `input_` at a pose that moves it to `moved`, by PCL's own loop: in single precision where
  // points are concerned.
  EulerDerivatives derivatives(const Cloud& moved, const Vector6d& pose) {
    EulerDerivatives result;
    result.score = computeDerivatives(result.gradient, result.hessian, moved, pose);
    return result;
  }

  // The same with PCL's formulas called for points that are moved in double precision.
  EulerDerivatives derivativesInDouble(const Eigen::Isometry3d& T, const Vector6d& pose) {
    EulerDerivatives result;
    computeAngleDerivatives(pose);
    std::vector<const pcl::VoxelGridCovariance<pcl::PointXYZ>::Leaf*> leaves;
    for (const auto& entry : target_cells_.getLeaves()) {
      if (entry.second.getPointCount() >= target_cells_.getMinPointPerVoxel()) leaves.push_back(&entry.second);
    }
    for (const pcl::PointXYZ& point : *input_) {
      const Eigen::Vector3d x = point.getVector3fMap().cast<double>();
      for (const auto* leaf : leaves) {
        const Eigen::Vector3d q = T * x - leaf->getMean();
        if (q.norm() > getResolution()) continue;
        computePointDerivatives(x);
        result.score += updateDerivatives(result.gradient, result.hessian, q, leaf->getInverseCov());
      }
    }
    return result;
  }

  // Our own level made of PCL's voxels.
  internal::NdtLevel level() {
    std::vector<VoxelStatistics> voxels;
    for (const auto& entry : target_cells_.getLeaves()) {
      const auto& leaf = entry.second;
      if (leaf.getPointCount() < target_cells_.getMinPointPerVoxel()) continue;
      VoxelStatistics voxel;
      voxel.voxel = (leaf.getMean() / getResolution()).array().floor().matrix().cast<int>();
      voxel.point_count = static_cast<std::uint64_t>(leaf.getPointCount());
      voxel.mean_from_centre = leaf.getMean() - (voxel.voxel.cast<double>().array() + 0.5).matrix() * getResolution();
      voxel.covariance = leaf.getCov();
      voxel.inverse_covariance = leaf.getInverseCov();
      voxels.push_back(voxel);
    }
    internal::NdtCells cells;
    cells.add(voxels, CellPrecision::SINGLE_AND_DOUBLE);
    return internal::NdtLevel(getResolution(), std::move(cells));
  }

  void prepare() {
    point_jacobian_.setZero();
    point_jacobian_.block<3, 3>(0, 0).setIdentity();
    point_hessian_.setZero();
  }
};

Cloud::Ptr xyzOf(const pcl::PointCloud<pcl::PointXYZL>& labelled) {
  auto cloud = pcl::make_shared<Cloud>();
  for (const auto& point : labelled) cloud->push_back({point.x, point.y, point.z});
  return cloud;
}

TEST(PclParity, ScoreGradientAndHessianOnTheSameVoxels) {
  PclNdt pcl_ndt;
  pcl_ndt.setInputTarget(xyzOf(streetCorner(1)));
  pcl_ndt.prepare();
  const internal::NdtLevel level = pcl_ndt.level();
  const auto source_cloud = xyzOf(streetCorner(2, 1000));
  pcl_ndt.setInputSource(source_cloud);
  SourcePoints source;
  for (const auto& p : *source_cloud) source.add(p.x, p.y, p.z, StructuralLabel::NON_GROUND);
  const NdtObjective objective(level, NeighborhoodSearchMethod::RADIUS,
                               scoreParameters(ScoreFunction::MAGNUSSON, 0.55, 1.0), {});
  NdtObjective::Workspace workspace;
  std::mt19937 random(9);
  std::uniform_real_distribution<double> uniform(-0.2, 0.2);
  for (int trial = 0; trial < 10; ++trial) {
    Vector6d pose;
    for (double& value : pose) value = uniform(random);
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation() = pose.head<3>();
    T.linear() = rotationFromEuler(pose.tail<3>());
    Cloud moved;
    pcl::transformPointCloud(*source_cloud, moved, T.matrix());
    const EulerDerivatives actual = eulerDerivatives(objective.evaluate(source, T, 1, workspace), pose.tail<3>());
    const auto expectNear = [&actual](const EulerDerivatives& expected, double relative) {
      EXPECT_NEAR(actual.score, expected.score, relative * expected.score);
      EXPECT_LT((actual.gradient - expected.gradient).norm(), relative * expected.gradient.norm());
      EXPECT_LT((actual.hessian - expected.hessian).norm(), relative * expected.hessian.norm());
    };
    // Nothing but the order of the sums differs.
    expectNear(pcl_ndt.derivativesInDouble(T, pose), 1e-11);
    // PCL's loop rounds the moved points to 2e-7 m, against voxels 3 cm thick.
    expectNear(pcl_ndt.derivatives(moved, pose), 1e-5);
  }
}

Cloud::Ptr cloudOf(const std::vector<LidarPoint>& points) {
  auto cloud = pcl::make_shared<Cloud>();
  for (const LidarPoint& point : points) cloud->emplace_back(point.x, point.y, point.z);
  return cloud;
}

struct Pair {
  Cloud::Ptr source, target;
  Eigen::Isometry3d T_target_source;
};

Pair realPair(const KittiSequence& sequence, const std::vector<Eigen::Isometry3d>& poses, int scan) {
  Pair pair{pcl::make_shared<Cloud>(), cloudOf(sequence.readScan(scan)), Eigen::Isometry3d::Identity()};
  pcl::VoxelGrid<pcl::PointXYZ> filter;
  filter.setLeafSize(0.5f, 0.5f, 0.5f);
  filter.setInputCloud(cloudOf(sequence.readScan(scan + 1)));
  filter.filter(*pair.source);
  pair.T_target_source = poses[static_cast<std::size_t>(scan)].inverse() * poses[static_cast<std::size_t>(scan) + 1];
  return pair;
}

class PclParityOnRealScans : public testing::TestWithParam<Optimizer> {};

TEST_P(PclParityOnRealScans, FinalPosesAgreeWherePclConverged) {
  const std::filesystem::path data = realDataFolder();
  if (data.empty()) GTEST_SKIP() << "no real scans";
  const KittiSequence sequence(data / "kitti" / "sequences" / "drive_0005");
  const std::vector<Eigen::Isometry3d> poses = sequence.posesLidar();
  std::mt19937 random(10);
  int converged = 0;
  for (int i = 0; i < 10; ++i) {
    const Pair pair = realPair(sequence, poses, 7 * i);
    const Eigen::Isometry3d start = pair.T_target_source * randomPose(random, 0.2, 0.01);
    pcl::NormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ> pcl_ndt;
    pcl_ndt.setTransformationEpsilon(1e-8);
    pcl_ndt.setMaximumIterations(100);
    pcl_ndt.setInputTarget(pair.target);
    pcl_ndt.setInputSource(pair.source);
    Cloud aligned;
    pcl_ndt.align(aligned, start.matrix().cast<float>());

    WeightedNormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ> our_ndt;
    our_ndt.setNeighborhoodSearchMethod(NeighborhoodSearchMethod::RADIUS);
    our_ndt.setOptimizer(GetParam());
    our_ndt.setTransformationEpsilon(1e-8);
    our_ndt.setMaximumIterations(100);
    our_ndt.setInputTarget(pair.target);
    our_ndt.setInputSource(pair.source);
    our_ndt.align(aligned, start.matrix().cast<float>());

    const Eigen::Matrix4d difference =
        pcl_ndt.getFinalTransformation().cast<double>().inverse() * our_ndt.getFinalTransformation().cast<double>();
    const double distance_m = difference.topRightCorner<3, 1>().norm();
    const double angle_deg = degreesFromRadians(rotationAngle(difference.topLeftCorner<3, 3>()));
    std::cout << "pair " << i << ": PCL " << pcl_ndt.getFinalNumIteration() << " iterations, likelihood "
              << pcl_ndt.getTransformationLikelihood() << "; ours " << our_ndt.getFinalNumIteration() << ", "
              << our_ndt.getTransformationLikelihood() << "; apart " << distance_m << " m, " << angle_deg << " deg\n";
    EXPECT_TRUE(our_ndt.hasConverged());
    // PCL calls itself converged at its iteration limit too.
    if (!pcl_ndt.hasConverged() || pcl_ndt.getFinalNumIteration() >= 100) continue;
    ++converged;
    EXPECT_LT(distance_m, 1e-3);
    EXPECT_LT(angle_deg, 0.005);
  }
  EXPECT_GE(converged, 5);
}

INSTANTIATE_TEST_SUITE_P(BothOptimizers, PclParityOnRealScans,
                         testing::Values(Optimizer::DAMPED_NEWTON, Optimizer::NEWTON_MORE_THUENTE));

}  // namespace
}  // namespace saw_ndt
