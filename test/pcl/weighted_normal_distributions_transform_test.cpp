#include "saw_ndt/pcl/weighted_normal_distributions_transform.h"

#include <gtest/gtest.h>
#include <pcl/common/transforms.h>

#include <limits>

#include "registration/registration_fixtures.h"
#include "saw_ndt/pcl/cloud_view.h"

namespace saw_ndt {

using namespace internal;

namespace {

using Labelled = pcl::PointCloud<pcl::PointXYZL>;
using Plain = pcl::PointCloud<pcl::PointXYZ>;
using Ndt = WeightedNormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ>;
using LabelledNdt = WeightedNormalDistributionsTransform<pcl::PointXYZL, pcl::PointXYZL>;

Plain::Ptr plain(const Labelled& labelled) {
  auto cloud = pcl::make_shared<Plain>();
  for (const auto& point : labelled) cloud->push_back({point.x, point.y, point.z});
  return cloud;
}

Eigen::Matrix4f guessOf(unsigned seed) {
  std::mt19937 random(seed);
  return randomPose(random, 0.3, 0.05).matrix().cast<float>();
}

double offIdentity(const Eigen::Matrix4f& T) { return (T - Eigen::Matrix4f::Identity()).norm(); }

TEST(WeightedNdt, AlignsThroughABasePointerAndMovesTheOutput) {
  pcl::Registration<pcl::PointXYZ, pcl::PointXYZ>::Ptr registration(new Ndt());
  const auto source = plain(streetCorner(2, 1000));
  registration->setInputTarget(plain(streetCorner(1)));
  registration->setInputSource(source);
  Plain output;
  registration->align(output, guessOf(1));
  EXPECT_TRUE(registration->hasConverged());
  EXPECT_LT(offIdentity(registration->getFinalTransformation()), 5e-3);
  Plain expected;
  pcl::transformPointCloud(*source, expected, registration->getFinalTransformation());
  ASSERT_EQ(output.size(), expected.size());
  for (std::size_t i = 0; i < output.size(); ++i) {
    EXPECT_EQ(output[i].getVector3fMap(), expected[i].getVector3fMap());
  }
  // Mean squared distance to the nearest of 10 times as many points on the same surfaces.
  EXPECT_LT(registration->getFitnessScore(), 0.01);
}

TEST(WeightedNdt, LabelsChangeTheScoreUnlessWeightsAreOff) {
  const auto target = pcl::make_shared<Labelled>(streetCorner(1));
  const auto source = pcl::make_shared<Labelled>(streetCorner(2, 1000));
  const auto likelihood = [&](bool use_weights) {
    LabelledNdt ndt;
    VoxelWeighting weighting;
    weighting.confidence = ConfidenceOptions::paper();
    ndt.setVoxelWeighting(weighting);
    ndt.setUseWeights(use_weights);
    ndt.setInputTarget(target);
    ndt.setInputSource(source);
    Labelled output;
    ndt.align(output, guessOf(1));
    EXPECT_TRUE(ndt.hasConverged());
    EXPECT_LT(offIdentity(ndt.getFinalTransformation()), 5e-3);
    return ndt.getTransformationLikelihood();
  };
  Ndt classical;
  classical.setInputTarget(plain(*target));
  classical.setInputSource(plain(*source));
  Plain output;
  classical.align(output, guessOf(1));
  EXPECT_EQ(likelihood(false), classical.getTransformationLikelihood());
  EXPECT_LT(likelihood(true), 0.9 * likelihood(false));
}

TEST(WeightedNdt, HonoursIndices) {
  auto cloud = streetCorner(2, 1000);
  const std::size_t good = cloud.size();
  for (int i = 0; i < 3000; ++i) {  // a wall that is not there
    pcl::PointXYZL point;
    point.x = 0.3f;
    point.y = -5.0f + 0.003f * static_cast<float>(i);
    point.z = 1.0f;
    point.label = 2;
    cloud.push_back(point);
  }
  auto indices = pcl::make_shared<pcl::Indices>();
  for (std::size_t i = 0; i < good; i += 2) indices->push_back(static_cast<pcl::index_t>(i));
  Ndt all, subset;
  for (Ndt* ndt : {&all, &subset}) {
    ndt->setInputTarget(plain(streetCorner(1)));
    ndt->setInputSource(plain(cloud));
  }
  subset.setIndices(indices);
  Plain output;
  all.align(output, guessOf(1));
  subset.align(output, guessOf(1));
  EXPECT_EQ(output.size(), indices->size());
  EXPECT_TRUE(subset.hasConverged());
  EXPECT_LT(offIdentity(subset.getFinalTransformation()), 5e-3);
  EXPECT_GT(subset.getTransformationLikelihood(), all.getTransformationLikelihood());
}

TEST(WeightedNdt, PassesOverPointsThatAreNotFinite) {
  const auto clean_source = plain(streetCorner(2, 1000)), clean_target = plain(streetCorner(1));
  auto source = pcl::make_shared<Plain>(*clean_source), target = pcl::make_shared<Plain>(*clean_target);
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  for (const auto& cloud : {source, target}) {
    cloud->push_back({nan, 0.0f, 0.0f});
    cloud->push_back({0.0f, inf, 0.0f});
    cloud->is_dense = false;
  }
  Ndt clean, dirty;
  clean.setInputTarget(clean_target);
  clean.setInputSource(clean_source);
  dirty.setInputTarget(target);
  dirty.setInputSource(source);
  Plain output;
  clean.align(output, guessOf(1));
  dirty.align(output, guessOf(1));
  EXPECT_EQ(clean.getFinalTransformation(), dirty.getFinalTransformation());
  EXPECT_TRUE(std::isfinite(dirty.getFitnessScore()));
}

TEST(WeightedNdt, EmptyAndUnusableCloudsDoNotConverge) {
  const auto good = plain(streetCorner(1));
  const auto empty = pcl::make_shared<Plain>();
  auto not_finite = pcl::make_shared<Plain>();
  not_finite->push_back({std::numeric_limits<float>::quiet_NaN(), 0.0f, 0.0f});
  not_finite->is_dense = false;
  Plain output;
  for (const auto& unusable : {empty, not_finite}) {
    Ndt ndt;
    ndt.setInputTarget(good);
    ndt.setInputSource(good);
    ndt.align(output);
    ASSERT_TRUE(ndt.hasConverged());
    ndt.setInputSource(unusable);
    ndt.align(output);
    EXPECT_FALSE(ndt.hasConverged());
    EXPECT_EQ(ndt.getAlignmentResult().status, AlignmentStatus::NO_SOURCE);
    ndt.setInputSource(good);
    ndt.setInputTarget(unusable);
    ndt.align(output);
    EXPECT_FALSE(ndt.hasConverged());
    EXPECT_EQ(ndt.getAlignmentResult().status, AlignmentStatus::NO_TARGET);
  }
  Ndt ndt;
  EXPECT_THROW(ndt.setInputTarget(nullptr), std::invalid_argument);
  EXPECT_THROW(ndt.setInputSource(nullptr), std::invalid_argument);
}

TEST(WeightedNdt, AFarPointNeitherOverflowsNorDisturbs) {
  auto target = plain(streetCorner(1));
  Ndt clean;
  clean.setInputTarget(pcl::make_shared<Plain>(*target));
  target->push_back({1e6f, -1e6f, 1e6f});
  target->push_back({3e38f, 0.0f, 0.0f});
  Ndt far;
  far.setInputTarget(target);
  Plain output;
  for (Ndt* ndt : {&clean, &far}) {
    ndt->setInputSource(plain(streetCorner(2, 500)));
    ndt->align(output, guessOf(1));
  }
  EXPECT_EQ(clean.getFinalTransformation(), far.getFinalTransformation());
}

TEST(WeightedNdt, AFarPointOfTheSourceIsPassedOverByBothOptimizers) {
  const auto clean = plain(streetCorner(2, 500));
  auto spoilt = pcl::make_shared<Plain>(*clean);
  spoilt->push_back({1e38f, 0.0f, 0.0f});
  spoilt->push_back({0.0f, -1e38f, 1e38f});
  Ndt ndt;
  ndt.setInputTarget(plain(streetCorner(1)));
  Plain output;
  for (const Optimizer optimizer : {Optimizer::DAMPED_NEWTON, Optimizer::NEWTON_MORE_THUENTE}) {
    ndt.setOptimizer(optimizer);
    ndt.setTransformationEpsilon(1e-6);  // PCL's optimizer takes it as squared metres
    ndt.setMaximumIterations(100);
    ndt.setInputSource(clean);
    ndt.align(output, guessOf(1));
    const Eigen::Matrix4f expected = ndt.getFinalTransformation();
    EXPECT_LT(offIdentity(expected), 5e-3);
    ndt.setInputSource(spoilt);
    ndt.align(output, guessOf(1));
    EXPECT_TRUE(ndt.hasConverged());
    EXPECT_EQ(ndt.getFinalTransformation(), expected);
    EXPECT_GT(ndt.getAlignmentResult().overlap, 0.8);
  }
}

// Half of the epsilon is the least step of PCL's line search, however far that leads.
TEST(WeightedNdt, HugeEpsilonsOfPclsOptimizerDoNotConvergeAndStayFinite) {
  Ndt ndt;
  ndt.setInputTarget(plain(streetCorner(1)));
  ndt.setInputSource(plain(streetCorner(2, 500)));
  ndt.setOptimizer(Optimizer::NEWTON_MORE_THUENTE);
  Eigen::Matrix4f guess = Eigen::Matrix4f::Identity();
  guess(0, 3) = 3.0f;
  guess(1, 3) = 2.0f;
  Plain output;
  for (const double epsilon : {1e3, 1e6, 1e12, 1e30, 1e300}) {
    for (const double step_size : {0.1, 1e3, 1e300}) {
      ndt.setTransformationEpsilon(epsilon);
      ndt.setStepSize(step_size);
      ndt.align(output, guess);
      EXPECT_FALSE(ndt.hasConverged());
      EXPECT_TRUE(ndt.getFinalTransformation().allFinite());
      for (const auto& point : output) ASSERT_TRUE(pcl::isFinite(point));
    }
  }
}

TEST(WeightedNdt, ACopyHasItsOwnKdTree) {
  const auto source = plain(streetCorner(2, 500));
  Ndt original;
  original.setInputTarget(plain(streetCorner(1)));
  original.setInputSource(source);
  Plain output;
  original.align(output, guessOf(1));
  const double fitness = original.getFitnessScore();
  Ndt constructed(original), assigned;
  assigned = original;
  auto elsewhere = pcl::make_shared<Plain>();
  for (const auto& point : streetCorner(1)) elsewhere->push_back({point.x + 50.0f, point.y, point.z});
  for (Ndt* copy : {&constructed, &assigned}) {
    EXPECT_NE(copy->getSearchMethodTarget(), original.getSearchMethodTarget());
    EXPECT_EQ(copy->getFinalTransformation(), original.getFinalTransformation());
    EXPECT_EQ(copy->getFitnessScore(), fitness);
    copy->setInputTarget(elsewhere);
    copy->align(output, guessOf(1));
    EXPECT_GT(copy->getFitnessScore(), 1000.0);  // the corner is 12 m wide, and 50 m away
    EXPECT_EQ(original.getFitnessScore(), fitness);
  }
}

TEST(WeightedNdt, ResolutionAndMinPointsTakeEffectInAnyOrder) {
  const auto target = plain(streetCorner(1));
  Ndt before, after;
  before.setResolution(0.5f);
  before.setMinPointPerVoxel(20);
  before.setInputTarget(target);
  after.setInputTarget(target);
  after.setResolution(0.5f);
  after.setMinPointPerVoxel(20);
  EXPECT_EQ(before.getTargetMap().voxelCount(), after.getTargetMap().voxelCount());
  EXPECT_EQ(after.getTargetMap().resolution(), 0.5);
  EXPECT_THROW(after.setResolution(0.0f), std::invalid_argument);
  EXPECT_THROW(after.setMinPointPerVoxel(2), std::invalid_argument);
}

TEST(WeightedNdt, HasConvergedIsFalseAtTheIterationLimitAndWithoutOverlap) {
  Ndt ndt;
  ndt.setInputTarget(plain(streetCorner(1)));
  ndt.setInputSource(plain(streetCorner(2, 500)));
  Plain output;
  Eigen::Matrix4f far = Eigen::Matrix4f::Identity();
  far(0, 3) = 5000.0f;
  for (const Optimizer optimizer : {Optimizer::DAMPED_NEWTON, Optimizer::NEWTON_MORE_THUENTE}) {
    ndt.setOptimizer(optimizer);
    ndt.setMaximumIterations(35);
    ndt.align(output, far);
    EXPECT_FALSE(ndt.hasConverged());
    ndt.setTransformationEpsilon(1e-12);
    ndt.setMaximumIterations(1);
    ndt.align(output, guessOf(1));
    EXPECT_FALSE(ndt.hasConverged());
    EXPECT_EQ(ndt.getFinalNumIteration(), 1);
  }
}

TEST(WeightedNdt, DoubleScalarKeepsMillimetresInProjectedCoordinates) {
  Eigen::Isometry3d T_map_corner = Eigen::Isometry3d::Identity();
  T_map_corner.translation() = Eigen::Vector3d(500000.25, 500000.75, 0.0);
  WeightedMapBuilder builder(1.0);
  addCloud(builder, streetCorner(1), T_map_corner);
  WeightedNormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ, double> ndt;
  ndt.setTargetMap(NdtTarget(builder.build()));
  ndt.setInputSource(plain(streetCorner(2, 1500)));
  std::mt19937 random(3);
  Plain output;
  ndt.align(output, (T_map_corner * randomPose(random, 0.3, 0.05)).matrix());
  EXPECT_TRUE(ndt.hasConverged());
  EXPECT_LT((ndt.getFinalTransformation() - T_map_corner.matrix()).norm(), 5e-3);
}

TEST(WeightedNdt, AMapIsAsGoodAsTheCloudItCameFrom) {
  const auto target = pcl::make_shared<Labelled>(streetCorner(1));
  const auto source = pcl::make_shared<Labelled>(streetCorner(2, 500));
  LabelledNdt from_cloud, from_map;
  from_cloud.setInputTarget(target);
  from_map.setTargetMap(from_cloud.getTargetMap());
  Labelled output;
  for (LabelledNdt* ndt : {&from_cloud, &from_map}) {
    ndt->setInputSource(source);
    ndt->align(output, guessOf(1));
  }
  EXPECT_EQ(from_cloud.getFinalTransformation(), from_map.getFinalTransformation());
  EXPECT_THROW(from_map.setResolution(0.5f), std::logic_error);
}

TEST(WeightedNdt, ALabelThatIsNoneIsRefusedAndTheOldTargetStays) {
  auto bad = pcl::make_shared<Labelled>(streetCorner(1, 100));
  (*bad)[7].label = 40;
  LabelledNdt ndt;
  ndt.setInputTarget(pcl::make_shared<Labelled>(streetCorner(1)));
  const NdtTarget map = ndt.getTargetMap();
  EXPECT_THROW(ndt.setInputTarget(bad), std::invalid_argument);
  EXPECT_TRUE(ndt.getTargetMap().sharesLevelsWith(map));
}

TEST(WeightedNdt, DoubleArithmeticTakesEffectInAnyOrderAndRefusesAMapWithoutDoubles) {
  const auto target = plain(streetCorner(1)), source = plain(streetCorner(2, 500));
  AlignmentOptions exact;
  exact.arithmetic = Arithmetic::DOUBLE;
  Ndt before, after, single;
  before.setAlignmentOptions(exact);
  before.setInputTarget(target);
  after.setInputTarget(target);
  after.setAlignmentOptions(exact);
  single.setInputTarget(target);
  Plain output;
  for (Ndt* ndt : {&before, &after, &single}) {
    ndt->setInputSource(source);
    ndt->align(output, guessOf(1));
    EXPECT_TRUE(ndt->hasConverged());
  }
  EXPECT_EQ(before.getFinalTransformation(), after.getFinalTransformation());
  // Both stop at a step of less than 1 mm.
  EXPECT_LT((before.getFinalTransformation() - single.getFinalTransformation()).norm(), 1e-3f);
  after.setTargetMap(single.getTargetMap());
  EXPECT_THROW(after.align(output, guessOf(1)), std::invalid_argument);
  after.setAlignmentOptions({});
  after.align(output, guessOf(1));
  EXPECT_EQ(after.getFinalTransformation(), single.getFinalTransformation());
}

TEST(WeightedNdt, ConvertTransformIsPcls) {
  Vector6d x;
  x << 1.0, -2.0, 3.0, 0.3, -0.2, 0.7;
  Eigen::Matrix4f matrix;
  Ndt::Affine3 affine;
  Ndt::convertTransform(x, matrix);
  Ndt::convertTransform(x, affine);
  const Eigen::Matrix3f R =
      (Eigen::AngleAxisf(0.3f, Eigen::Vector3f::UnitX()) * Eigen::AngleAxisf(-0.2f, Eigen::Vector3f::UnitY()) *
       Eigen::AngleAxisf(0.7f, Eigen::Vector3f::UnitZ()))
          .toRotationMatrix();
  EXPECT_LT((matrix.topLeftCorner<3, 3>() - R).norm(), 1e-6f);
  EXPECT_EQ(matrix, affine.matrix());
  EXPECT_LT((eulerFromRotation(R.cast<double>()) - x.tail<3>()).norm(), 1e-6);
}

TEST(WeightedNdt, DefaultsArePcls) {
  Ndt ndt;
  EXPECT_EQ(ndt.getMaximumIterations(), 35);
  EXPECT_EQ(ndt.getTransformationEpsilon(), 0.1);
  EXPECT_EQ(ndt.getResolution(), 1.0f);
  EXPECT_EQ(ndt.getStepSize(), 0.1);
  EXPECT_EQ(ndt.getOulierRatio(), 0.55);
  EXPECT_EQ(ndt.getOutlierRatio(), 0.55);
  EXPECT_EQ(ndt.getVoxelWeighting().min_points_per_voxel, 6);
}

}  // namespace
}  // namespace saw_ndt
