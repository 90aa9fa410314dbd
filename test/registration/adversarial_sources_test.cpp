#include <gtest/gtest.h>

#include <limits>

#include "expect_throws.h"
#include "registration/registration_fixtures.h"
#include "saw_ndt/localization/global_search.h"
#include "saw_ndt/registration/ndt_aligner.h"
#include "saw_ndt/registration/pose_scorer.h"

namespace saw_ndt {
namespace {

NdtTarget cornerTarget() { return exactTargetOf(streetCorner(1)); }

AlignmentResult align(const NdtTarget& target, const SourcePoints& source, const AlignmentOptions& options = {}) {
  Eigen::Isometry3d guess = Eigen::Isometry3d::Identity();
  guess.translation() << 0.2, -0.1, 0.05;
  return NdtAligner().align(target, source, guess, options);
}

TEST(AdversarialSources, AreRefusedWithWhatIsWrong) {
  const NdtTarget target = cornerTarget();
  const GlobalSearch search(target);
  const auto refused = [&](const std::string& reason, auto change) {
    SCOPED_TRACE(reason);
    SourcePoints source = sourceOf(streetCorner(2, 100));
    change(source);
    for (const Optimizer optimizer : {Optimizer::DAMPED_NEWTON, Optimizer::NEWTON_MORE_THUENTE}) {
      AlignmentOptions options;
      options.optimizer = optimizer;
      expectThrows<std::invalid_argument>([&] { align(target, source, options); }, {"source", reason});
    }
    expectThrows<std::invalid_argument>([&] { PoseScorer(target, source); }, {"source", reason});
    expectThrows<std::invalid_argument>([&] { search.candidates(source); }, {"source", reason});
  };
  for (const float value : {std::numeric_limits<float>::quiet_NaN(), 3e9F, 1e30F,
                            std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()}) {
    refused("not finite", [&](SourcePoints& source) { source.x.front() = value; });
    refused("not finite", [&](SourcePoints& source) { source.y.back() = value; });
    refused("not finite", [&](SourcePoints& source) { source.z[17] = value; });
  }
  for (const std::uint8_t label : std::initializer_list<std::uint8_t>{3, 200, 255}) {
    refused("label", [&](SourcePoints& source) { source.label.back() = label; });
  }
  refused("labels", [](SourcePoints& source) { source.label.pop_back(); });
  refused(" y", [](SourcePoints& source) { source.y.pop_back(); });
  refused(" z", [](SourcePoints& source) { source.z.push_back(0.0F); });
}

TEST(AdversarialSources, WithLabelsOnAnUnlabelledTargetAndWithoutOnALabelledOneAreAlignedClassically) {
  const pcl::PointCloud<pcl::PointXYZL> corner = streetCorner(1);
  WeightedMapBuilder unlabelled(1.0);
  unlabelled.addScan(viewOf(corner), {}, Eigen::Isometry3d::Identity());
  const NdtTarget targets[] = {cornerTarget(), NdtTarget(unlabelled.build())};
  const pcl::PointCloud<pcl::PointXYZL> scan = streetCorner(2, 500);
  const AlignmentResult classical = align(targets[1], sourceOf(scan, false));
  for (const bool labelled : {true, false}) {
    const AlignmentResult result = align(targets[labelled ? 1 : 0], sourceOf(scan, labelled));
    EXPECT_TRUE(result.converged());
    // The voxels have the same points in both, and each pair weighs 1.
    EXPECT_EQ(result.T_map_source.matrix(), classical.T_map_source.matrix()) << labelled;
    EXPECT_EQ(result.score, classical.score);
  }
}

// The sum of such points drags the mean of all away by as much as a voxel's number can tell, and more.
TEST(AdversarialSources, AFewFarPointsDoNotDisturbTheOthers) {
  const NdtTarget target = cornerTarget();
  const SourcePoints clean = sourceOf(streetCorner(2, 500));
  for (const Optimizer optimizer : {Optimizer::DAMPED_NEWTON, Optimizer::NEWTON_MORE_THUENTE}) {
    AlignmentOptions options;
    options.optimizer = optimizer;
    options.line_search_min_step = 1e-6;
    options.max_iterations = 100;
    const AlignmentResult expected = align(target, clean, options);
    ASSERT_TRUE(expected.converged());
    for (const float metres : {1e4F, 1e5F, 1e6F, 1e7F, 1e8F, 1e9F, 1.9e9F}) {
      for (const int count : {1, 20}) {
        SourcePoints source = clean;
        for (int i = 0; i < count; ++i) source.add(metres, -metres, 0.0F, StructuralLabel::NON_GROUND);
        const AlignmentResult result = align(target, source, options);
        EXPECT_TRUE(result.converged()) << metres;
        // The same maximum, to within the epsilons of the step that ends the search.
        EXPECT_LT((result.T_map_source.matrix() - expected.T_map_source.matrix()).norm(), 1e-3)
            << metres << " " << count;
        EXPECT_LT(result.rotation_centre.norm(), 100.0) << metres;
        EXPECT_TRUE(result.covariance.allFinite()) << metres;
      }
    }
  }
}

TEST(AdversarialSources, FarPointsOfASourceThatIsFarItselfDoNotDisturbTheOthers) {
  const Eigen::Vector3d away(5000.0, -3000.0, 20.0);
  const NdtTarget target = cornerTarget();
  SourcePoints source = sourceOf(streetCorner(2, 500));
  for (std::size_t i = 0; i < source.size(); ++i) {
    source.x[i] += static_cast<float>(away.x());
    source.y[i] += static_cast<float>(away.y());
    source.z[i] += static_cast<float>(away.z());
  }
  source.add(8e8F, 8e8F, -8e8F, StructuralLabel::NON_GROUND);
  const Eigen::Isometry3d T_expected(Eigen::Translation3d(-away));
  const AlignmentResult result =
      NdtAligner().align(target, source, Eigen::Translation3d(0.2, -0.1, 0.05) * T_expected, {});
  EXPECT_TRUE(result.converged());
  EXPECT_LT((result.rotation_centre - away).norm(), 20.0);
  // Single precision rounds coordinates of 5 km to 0.5 mm, at random.
  EXPECT_LT((result.T_map_source * result.rotation_centre - T_expected * result.rotation_centre).norm(), 5e-3);
}

}  // namespace
}  // namespace saw_ndt
