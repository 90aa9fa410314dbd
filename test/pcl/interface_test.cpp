#include <gtest/gtest.h>

#include <cmath>
#include <type_traits>

#include "pcl/pcl_ndt.h"
#include "saw_ndt/pcl/weighted_normal_distributions_transform.h"

// Code written against pcl::NormalDistributionsTransform must compile with ours and mean the same. Each test runs on
// both.
namespace saw_ndt {
namespace {

using Point = pcl::PointXYZ;

template <typename Ndt>
class DropInInterface : public testing::Test {};

using Both =
    testing::Types<pcl::NormalDistributionsTransform<Point, Point>, WeightedNormalDistributionsTransform<Point, Point>>;
TYPED_TEST_SUITE(DropInInterface, Both, );  // the comma is for Clang, which else warns of the macro

TYPED_TEST(DropInInterface, HasPclsTypes) {
  using Ndt = TypeParam;
  static_assert(std::is_base_of_v<pcl::Registration<Point, Point>, Ndt>);
  static_assert(std::is_same_v<typename Ndt::Ptr, pcl::shared_ptr<Ndt>>);
  static_assert(std::is_same_v<typename Ndt::ConstPtr, pcl::shared_ptr<const Ndt>>);
  static_assert(std::is_same_v<typename Ndt::Matrix4, Eigen::Matrix4f>);
#if PCL_VERSION_COMPARE(>=, 1, 12, 1)
  static_assert(std::is_same_v<typename Ndt::Vector3, Eigen::Vector3f>);
  static_assert(std::is_same_v<typename Ndt::Affine3, Eigen::Affine3f>);
#endif
  const typename Ndt::Ptr ndt(new Ndt);
  const typename Ndt::ConstPtr constant = ndt;
  EXPECT_TRUE(constant);
}

TYPED_TEST(DropInInterface, HasPclsDefaults) {
  const auto ndt = pcl::make_shared<TypeParam>();
  EXPECT_EQ(ndt->getResolution(), 1.0f);
  EXPECT_EQ(ndt->getStepSize(), 0.1);
  EXPECT_EQ(ndt->getOulierRatio(), 0.55);
  EXPECT_EQ(ndt->getMaximumIterations(), 35);
  EXPECT_EQ(ndt->getTransformationEpsilon(), 0.1);
}

TYPED_TEST(DropInInterface, ReadsBackWhatWasSet) {
  const auto ndt = pcl::make_shared<TypeParam>();
  ndt->setStepSize(0.05);
  ndt->setOulierRatio(0.4);
  ndt->setMinPointPerVoxel(8);
  ndt->setMaximumIterations(50);
  ndt->setTransformationEpsilon(1e-8);
  ndt->setTransformationRotationEpsilon(0.999999);
  const pcl::PointCloud<Point>::Ptr target(new pcl::PointCloud<Point>);
  for (int i = 0; i < 100; ++i) {
    const float angle = 0.1f * static_cast<float>(i);
    target->push_back(Point(std::cos(angle), std::sin(angle), 0.01f * static_cast<float>(i)));
  }
  ndt->setInputTarget(target);
  ndt->setResolution(2.0f);
  EXPECT_EQ(ndt->getResolution(), 2.0f);
  EXPECT_EQ(ndt->getStepSize(), 0.05);
  EXPECT_EQ(ndt->getOulierRatio(), 0.4);
  EXPECT_EQ(ndt->getMaximumIterations(), 50);
  EXPECT_EQ(ndt->getTransformationEpsilon(), 1e-8);
  EXPECT_EQ(ndt->getTransformationRotationEpsilon(), 0.999999);
  EXPECT_EQ(ndt->getInputTarget(), target);
}

TYPED_TEST(DropInInterface, ConvertsAPoseVectorAsPcl) {
  Eigen::Matrix<double, 6, 1> pose;
  pose << 1.0, -2.0, 3.0, 0.1, -0.2, 0.3;
  const Eigen::Affine3f expected =
      Eigen::Translation3f(1.0f, -2.0f, 3.0f) * Eigen::AngleAxisf(0.1f, Eigen::Vector3f::UnitX()) *
      Eigen::AngleAxisf(-0.2f, Eigen::Vector3f::UnitY()) * Eigen::AngleAxisf(0.3f, Eigen::Vector3f::UnitZ());
  Eigen::Affine3f affine;
  TypeParam::convertTransform(pose, affine);
  EXPECT_TRUE(affine.isApprox(expected, 1e-6f));
  Eigen::Matrix4f matrix;
  TypeParam::convertTransform(pose, matrix);
  EXPECT_TRUE(matrix.isApprox(expected.matrix(), 1e-6f));
}

TYPED_TEST(DropInInterface, AlignsThroughThePointerToItsBase) {
  const pcl::PointCloud<Point>::Ptr cloud(new pcl::PointCloud<Point>);
  for (int i = 0; i < 40; ++i) {
    for (int j = 0; j < 40; ++j) {
      const float a = 0.1f * static_cast<float>(i), b = 0.1f * static_cast<float>(j);
      cloud->push_back(Point(a, b, 0.05f * std::sin(a)));
      cloud->push_back(Point(a, 0.05f * std::sin(b), b));
      cloud->push_back(Point(0.05f * std::sin(a + b), a, b));
    }
  }
  const auto ndt = pcl::make_shared<TypeParam>();
  const typename pcl::Registration<Point, Point>::Ptr registration = ndt;
  registration->setInputTarget(cloud);
  registration->setInputSource(cloud);
  Eigen::Matrix4f guess = Eigen::Matrix4f::Identity();
  guess(0, 3) = 0.02f;
  registration->setTransformationEpsilon(1e-6);
  registration->setMaximumIterations(50);
  pcl::PointCloud<Point> aligned;
  registration->align(aligned, guess);
  EXPECT_TRUE(registration->hasConverged());
  EXPECT_TRUE(registration->getFinalTransformation().isApprox(Eigen::Matrix4f::Identity(), 5e-3f))
      << registration->getFinalTransformation();
  EXPECT_LT(registration->getFitnessScore(), 1e-4);
  EXPECT_EQ(aligned.size(), cloud->size());
  EXPECT_GE(ndt->getFinalNumIteration(), 1);
#if PCL_VERSION_COMPARE(>=, 1, 12, 0)
  EXPECT_GT(ndt->getTransformationLikelihood(), 0.0);
#endif
}

// Names of later versions of PCL and of its multi-threaded derivatives, which PCL 1.13 lacks.
TEST(DropInInterfaceBeyondPcl, HasTheNamesOfOtherVersions) {
  WeightedNormalDistributionsTransform<Point, Point> ndt;
  ndt.setOutlierRatio(0.3);
  EXPECT_EQ(ndt.getOutlierRatio(), 0.3);
  EXPECT_EQ(ndt.getOulierRatio(), 0.3);
  ndt.setNumberOfThreads(2);
  ndt.setNeighborhoodSearchMethod(NeighborhoodSearchMethod::DIRECT1);
  EXPECT_EQ(ndt.getNeighborhoodSearchMethod(), NeighborhoodSearchMethod::DIRECT1);
  EXPECT_EQ(ndt.getTransformationProbability(), ndt.getTransformationLikelihood());
}

}  // namespace
}  // namespace saw_ndt
