#include <gtest/gtest.h>

#include <limits>

#include "expect_throws.h"
#include "registration/registration_fixtures.h"
#include "saw_ndt/pcl/ground_subsampling.h"
#include "saw_ndt/pcl/range_image_segmentation.h"
#include "saw_ndt/pcl/weighted_normal_distributions_transform.h"

// What PCL does not check of what its users ask for.
namespace saw_ndt {
namespace {

using Plain = pcl::PointCloud<pcl::PointXYZ>;
using Labelled = pcl::PointCloud<pcl::PointXYZL>;
using Ndt = WeightedNormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ>;
using LabelledNdt = WeightedNormalDistributionsTransform<pcl::PointXYZL, pcl::PointXYZL>;

Plain::Ptr plainCorner(unsigned seed, int points_per_surface) {
  auto cloud = pcl::make_shared<Plain>();
  for (const pcl::PointXYZL& point : streetCorner(seed, points_per_surface)) {
    cloud->push_back({point.x, point.y, point.z});
  }
  return cloud;
}

Labelled::Ptr corner(unsigned seed, int points_per_surface) {
  return pcl::make_shared<Labelled>(streetCorner(seed, points_per_surface));
}

constexpr pcl::index_t kNoPoints[] = {-1, std::numeric_limits<pcl::index_t>::min(),
                                      std::numeric_limits<pcl::index_t>::max(), 310};

TEST(Misuse, IndicesBeyondTheCloudAreNamedByFilters) {
  const auto cloud = corner(2, 100);
  ASSERT_EQ(cloud->size(), 310U);
  for (const pcl::index_t index : kNoPoints) {
    const auto indices = pcl::make_shared<pcl::Indices>(pcl::Indices{0, 5, index, 7});
    RangeImageSegmentation<pcl::PointXYZL> segmentation;
    GroundSubsampling<pcl::PointXYZL> subsampling;
    for (pcl::FilterIndices<pcl::PointXYZL>* filter :
         {static_cast<pcl::FilterIndices<pcl::PointXYZL>*>(&segmentation),
          static_cast<pcl::FilterIndices<pcl::PointXYZL>*>(&subsampling)}) {
      filter->setInputCloud(cloud);
      filter->setIndices(indices);
      pcl::Indices kept;
      expectThrows<std::out_of_range>([&] { filter->filter(kept); }, {std::to_string(index), "310 points"});
      Labelled output;
      EXPECT_THROW(filter->filter(output), std::out_of_range);
      // Another cloud, of no points, under indices of the old one.
      filter->setInputCloud(pcl::make_shared<Labelled>());
      EXPECT_THROW(filter->filter(kept), std::out_of_range);
    }
    segmentation.setInputCloud(cloud);
    Labelled output;
    EXPECT_THROW(segmentation.segment(output), std::out_of_range);
  }
}

TEST(Misuse, IndicesBeyondTheSourceAreNamedByAlign) {
  Ndt ndt;
  ndt.setInputTarget(plainCorner(1, 1000));
  const auto source = plainCorner(2, 100);
  Plain output;
  ndt.setInputSource(source);
  ndt.align(output);
  ASSERT_TRUE(ndt.hasConverged());
  for (const pcl::index_t index : kNoPoints) {
    ndt.setIndices(pcl::make_shared<pcl::Indices>(pcl::Indices{0, 5, index, 7}));
    expectThrows<std::out_of_range>([&] { ndt.align(output); }, {std::to_string(index), "310 points"});
    EXPECT_THROW(ndt.align(output, Eigen::Matrix4f::Identity()), std::out_of_range);
  }
  // Through PCL's own class, which reads the point before it asks: one that is beyond this source, but is there.
  const auto shorter = pcl::make_shared<Plain>(*source);
  shorter->resize(300);
  ndt.setIndices(pcl::make_shared<pcl::Indices>(pcl::Indices{0, 5, 305, 7}));
  ndt.setInputSource(shorter);
  pcl::Registration<pcl::PointXYZ, pcl::PointXYZ>& base = ndt;
  EXPECT_THROW(base.align(output), std::out_of_range);
  ndt.setInputSource(source);
  ndt.align(output);
  EXPECT_EQ(output.size(), 4U);
}

TEST(Misuse, ASourceOfACopyLeavesThePointsOfTheOriginalAlone) {
  Ndt original;
  original.setInputTarget(plainCorner(1, 1000));
  original.setInputSource(plainCorner(2, 100));
  Plain output;
  original.align(output);
  Ndt copy(original), assigned;
  assigned = original;
  EXPECT_TRUE(original.getIndices());
  EXPECT_NE(copy.getIndices(), original.getIndices());
  EXPECT_NE(assigned.getIndices(), original.getIndices());
  copy.setInputSource(plainCorner(3, 200));
  copy.align(output);
  EXPECT_EQ(output.size(), 620U);
  EXPECT_EQ(original.getIndices()->size(), 310U);
  assigned.align(output);
  EXPECT_EQ(assigned.getFinalTransformation(), original.getFinalTransformation());
}

TEST(Misuse, WithoutASourceThereIsNoFitness) {
  Ndt without_any, without_source, without_target;
  without_source.setInputTarget(plainCorner(1, 100));
  without_target.setInputSource(plainCorner(1, 100));
  for (Ndt* ndt : {&without_any, &without_source, &without_target}) {
    // As PCL says where no point of the source has a neighbour.
    EXPECT_EQ(ndt->getFitnessScore(), std::numeric_limits<double>::max());
    Plain output;
    ndt->align(output);
    EXPECT_FALSE(ndt->hasConverged());
    EXPECT_EQ(ndt->getFitnessScore(), std::numeric_limits<double>::max());
    const Ndt copy(*ndt);
    EXPECT_FALSE(Ndt(copy).hasConverged());
  }
  without_source.setIndices(0, 0, 1, 1);  // a block of a source of no rows
  Plain output;
  without_source.align(output);
  EXPECT_EQ(without_source.getAlignmentResult().status, AlignmentStatus::NO_SOURCE);
}

TEST(Misuse, MoreThreadsThanThereMayBeAreAsManyAsThereAre) {
  Ndt ndt;
  ndt.setInputTarget(plainCorner(1, 1000));
  ndt.setInputSource(plainCorner(2, 100));
  Plain output;
  ndt.setNumberOfThreads(1);
  ndt.align(output);
  const Eigen::Matrix4f expected = ndt.getFinalTransformation();
  for (const unsigned int threads : {100000U, 0x7fffffffU, 0x80000000U, 0xffffffffU}) {
    ndt.setNumberOfThreads(threads);
    ndt.align(output);
    EXPECT_EQ(ndt.getFinalTransformation(), expected) << threads;
  }
}

TEST(Misuse, LabelsOfOthersDoNotMatterWhereWeightsAreOff) {
  const auto target = corner(1, 1000), source = corner(2, 200);
  const auto classes = pcl::make_shared<Labelled>(*target), source_classes = pcl::make_shared<Labelled>(*source);
  for (const auto& cloud : {classes, source_classes}) {
    for (pcl::PointXYZL& point : *cloud) point.label = 7;
  }
  Ndt classical;
  classical.setInputTarget(plainCorner(1, 1000));
  classical.setInputSource(plainCorner(2, 200));
  Plain plain_output;
  classical.align(plain_output);
  LabelledNdt ndt;
  EXPECT_THROW(ndt.setInputTarget(classes), std::invalid_argument);
  ndt.setUseWeights(false);
  ndt.setInputTarget(classes);
  ndt.setInputSource(source_classes);
  Labelled output;
  ndt.align(output);
  EXPECT_TRUE(ndt.hasConverged());
  EXPECT_EQ(ndt.getFinalTransformation(), classical.getFinalTransformation());
  // With weights they matter, whatever the order of calls.
  EXPECT_THROW(ndt.setUseWeights(true), std::invalid_argument);
  EXPECT_FALSE(ndt.getUseWeights());
  AlignmentOptions weighted = ndt.getAlignmentOptions();
  weighted.use_weights = true;
  EXPECT_THROW(ndt.setAlignmentOptions(weighted), std::invalid_argument);
  EXPECT_FALSE(ndt.getUseWeights());
  ndt.align(output);
  EXPECT_EQ(ndt.getFinalTransformation(), classical.getFinalTransformation());
  ndt.setInputTarget(target);
  ndt.setUseWeights(true);
  EXPECT_THROW(ndt.align(output), std::invalid_argument);
  ndt.setInputSource(source);
  ndt.align(output);
  EXPECT_TRUE(ndt.hasConverged());
  EXPECT_TRUE(ndt.getTargetMap().labelled());
}

TEST(Misuse, EpsilonsAndStepsThatAreNoNumbersAreRefusedOrHarmless) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  for (const Optimizer optimizer : {Optimizer::DAMPED_NEWTON, Optimizer::NEWTON_MORE_THUENTE}) {
    for (const double value : {nan, infinity, -infinity, -1.0, 0.0, 5e-324, 1.7e308}) {
      for (int which = 0; which < 4; ++which) {
        Ndt ndt;
        ndt.setOptimizer(optimizer);
        ndt.setInputTarget(plainCorner(1, 200));
        ndt.setInputSource(plainCorner(2, 50));
        if (which == 0) ndt.setTransformationEpsilon(value);
        if (which == 1) ndt.setTransformationRotationEpsilon(value);
        if (which == 2) ndt.setStepSize(value);
        if (which == 3) ndt.setOutlierRatio(value);
        Eigen::Matrix4f guess = Eigen::Matrix4f::Identity();
        guess(0, 3) = 0.2F;
        Plain output;
        try {
          ndt.align(output, guess);
        } catch (const std::invalid_argument&) {
          continue;
        }
        EXPECT_TRUE(ndt.getFinalTransformation().allFinite()) << value << " " << which;
        if (ndt.hasConverged()) {
          // PCL's optimizer ends where its step is below the root of 0.1 m^2.
          EXPECT_LT((ndt.getFinalTransformation() - Eigen::Matrix4f::Identity()).norm(), 0.35F)
              << value << " " << which;
        }
      }
    }
  }
}

TEST(Misuse, GuessesThatAreNoRigidTransformsGiveNoneOrOne) {
  Ndt ndt;
  ndt.setInputTarget(plainCorner(1, 500));
  ndt.setInputSource(plainCorner(2, 100));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<Eigen::Matrix4f> guesses(6, Eigen::Matrix4f::Identity());
  guesses[0].setZero();
  guesses[1].topLeftCorner<3, 3>() *= 1e30F;
  guesses[2].col(1) *= -1.0F;
  guesses[3](0, 3) = 1e30F;
  guesses[4].setConstant(3e38F);
  guesses[5].row(3).setConstant(5.0F);
  Plain output;
  for (const Eigen::Matrix4f& guess : guesses) {
    ndt.align(output, guess);
    const Eigen::Matrix4f T = ndt.getFinalTransformation();
    EXPECT_TRUE(T.allFinite()) << guess;
    EXPECT_TRUE((T.topLeftCorner<3, 3>().isUnitary(1e-4F))) << T;
    EXPECT_GT((T.topLeftCorner<3, 3>().determinant()), 0.0F) << T;
    EXPECT_EQ(T.row(3), Eigen::RowVector4f(0.0F, 0.0F, 0.0F, 1.0F));
  }
  for (const float value : {nan, std::numeric_limits<float>::infinity()}) {
    Eigen::Matrix4f guess = Eigen::Matrix4f::Identity();
    guess(1, 3) = value;
    EXPECT_THROW(ndt.align(output, guess), std::invalid_argument);
  }
}

}  // namespace
}  // namespace saw_ndt
