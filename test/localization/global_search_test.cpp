#include "saw_ndt/localization/global_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <thread>
#include <vector>

#include "expect_throws.h"
#include "localization/synthetic_drive.h"
#include "saw_ndt/localization/localizer.h"
#include "saw_ndt/localization/scan_preparation.h"
#include "saw_ndt/map/weighted_map_builder.h"

namespace saw_ndt {
namespace {

constexpr double kSensorHeight_m = 1.73;

Eigen::Isometry3d streetPose(double x, double y, double yaw_deg) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << x, y, kSensorHeight_m;
  T.linear() = rotationFromVector({0.0, 0.0, radiansFromDegrees(yaw_deg)});
  return T;
}

SensorModel sensor() { return SensorModel::named("HDL-64E"); }

/// The map of the street, and of copies of it.
WeightedVoxelMap streetMap(bool segment, const std::vector<Eigen::Vector3d>& copies_at = {Eigen::Vector3d::Zero()}) {
  WeightedMapBuilder builder(0.5);
  ScanSegmenter segmenter{SegmentationOptions()};
  unsigned seed = 1000;
  for (const double x : {-20.0, -10.0, 0.0, 10.0, 20.0, 30.0}) {
    const std::vector<LidarPoint> scan = scanBlocks(streetBlocks(), sensor(), streetPose(x, 1.0, 0.0), ++seed);
    std::vector<StructuralLabel> labels;
    if (segment) segmenter.segment(viewOf(scan), labels);
    for (const Eigen::Vector3d& copy_at : copies_at) {
      Eigen::Isometry3d T = streetPose(x, 1.0, 0.0);
      T.translation() += copy_at;
      builder.addScan(viewOf(scan), segment ? LabelView(labels) : LabelView(), T);
    }
  }
  return builder.build();
}

LocalizerOptions optionsOf(const std::string& method) {
  LocalizerOptions options;
  options.method = LocalizationMethod::named(method);
  options.alignment.threads = 2;
  return options;
}

bool isAt(const Eigen::Isometry3d& T, const Eigen::Isometry3d& expected, double metres, double degrees) {
  const Eigen::Isometry3d away = expected.inverse() * T;
  return away.translation().norm() < metres && degreesFromRadians(rotationAngle(away.linear())) < degrees;
}

const std::vector<Eigen::Isometry3d>& testPoses() {
  static const std::vector<Eigen::Isometry3d> poses = {streetPose(-15.3, 2.2, 190.0), streetPose(-4.8, -3.1, 71.0),
                                                       streetPose(6.4, 0.7, -38.0), streetPose(17.7, 3.6, 133.0),
                                                       streetPose(27.1, -2.4, -101.0)};
  return poses;
}

/// Sources of scans from a pose in the street, labelled or not.
class StreetScans {
 public:
  explicit StreetScans(bool segment) : preparation_(optionsFor(segment)) {}
  const SourcePoints& at(const Eigen::Isometry3d& T_street_lidar, unsigned seed) {
    scan_ = scanBlocks(streetBlocks(), sensor(), T_street_lidar, seed);
    return preparation_.prepare(viewOf(scan_));
  }

 private:
  static ScanPreparationOptions optionsFor(bool segment) {
    ScanPreparationOptions options;
    options.segment = segment;
    return options;
  }

  ScanPreparation preparation_;
  std::vector<LidarPoint> scan_;
};

TEST(GlobalSearch, ThePoseIsAmongTheFirstCandidatesWithAndWithoutLabels) {
  for (const bool segment : {true, false}) {
    const NdtTarget target(streetMap(segment), LocalizationMethod::named(segment ? "weighted" : "classical").voxels);
    const GlobalSearch search(target);
    StreetScans scans(segment);
    unsigned seed = 1;
    for (const Eigen::Isometry3d& T_map_lidar : testPoses()) {
      const SourcePoints& source = scans.at(T_map_lidar, seed++);
      const std::vector<PoseCandidate> candidates = search.candidates(source);
      ASSERT_FALSE(candidates.empty());
      // A column is 1 m wide, headings are 2 degrees apart. The street has little that is unlike the rest of it: the
      // first five are what a localizer aligns.
      const auto end = candidates.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(5, candidates.size()));
      const auto found = std::find_if(candidates.begin(), end, [&](const PoseCandidate& candidate) {
        return isAt(candidate.T_map_base, T_map_lidar, 1.5, 4.0);
      });
      ASSERT_NE(found, end) << T_map_lidar.matrix();
      EXPECT_NEAR(found->T_map_base.translation().z(), kSensorHeight_m, 0.15);
      EXPECT_GT(found->matched_share, 0.7 * candidates.front().matched_share);
      for (std::size_t i = 1; i < candidates.size(); ++i) {
        EXPECT_LE(candidates[i].matched_share, candidates[i - 1].matched_share);
      }
      const std::vector<PoseCandidate> by_one_thread = search.candidates(source, {}, 1);
      ASSERT_EQ(by_one_thread.size(), candidates.size());
      for (std::size_t i = 0; i < candidates.size(); ++i) {
        EXPECT_EQ(by_one_thread[i].T_map_base.matrix(), candidates[i].T_map_base.matrix());
      }
    }
  }
}

TEST(GlobalSearch, ARegionBoundsPositionAndHeading) {
  const NdtTarget target(streetMap(true), LocalizationMethod::named("weighted").voxels);
  const GlobalSearch search(target);
  StreetScans scans(true);
  const Eigen::Isometry3d T_map_lidar = streetPose(6.4, 0.7, -38.0);
  const SourcePoints& source = scans.at(T_map_lidar, 5);
  SearchRegion region{streetPose(9.0, 0.0, -20.0), 6.0, 30.0};
  ASSERT_FALSE(search.candidates(source, region).empty());
  EXPECT_TRUE(isAt(search.candidates(source, region).front().T_map_base, T_map_lidar, 1.5, 4.0));
  region.heading_deg = 5.0;
  for (const PoseCandidate& candidate : search.candidates(source, region)) {
    const Eigen::Isometry3d away = region.T_map_base.inverse() * candidate.T_map_base;
    EXPECT_LT(away.translation().head<2>().norm(), region.radius_m + 1.5);
    EXPECT_LT(std::abs(degreesFromRadians(heading(away))), region.heading_deg + 2.1);
  }
}

TEST(GlobalSearch, FindsNothingWhereThereIsNothing) {
  SourcePoints empty;
  const NdtTarget target(streetMap(true), LocalizationMethod::named("weighted").voxels);
  EXPECT_TRUE(GlobalSearch(target).candidates(empty).empty());
  SourcePoints few;
  for (int i = 0; i < 5; ++i) few.add(static_cast<float>(5 * i), 3.0F, 1.0F, StructuralLabel::NON_GROUND);
  EXPECT_TRUE(GlobalSearch(target).candidates(few).empty());
  few.add(std::numeric_limits<float>::quiet_NaN(), 0.0F, 0.0F, StructuralLabel::GROUND);
  expectThrows<std::invalid_argument>([&] { GlobalSearch(target).candidates(few); }, {"not finite"});
  StreetScans scans(true);
  EXPECT_TRUE(GlobalSearch(NdtTarget()).candidates(scans.at(testPoses().front(), 1)).empty());
}

TEST(GlobalSearch, OptionsAreChecked) {
  GlobalSearchOptions options;
  options.cells = 12;
  expectThrows<std::invalid_argument>([&] { options.check(); }, {"cells", "12"});
  options = {};
  options.heading_step_deg = 0.0;
  expectThrows<std::invalid_argument>([&] { options.check(); }, {"heading_step_deg"});
  options = {};
  options.least_share = 1.5;
  expectThrows<std::invalid_argument>([&] { options.check(); }, {"least_share", "1.5"});
}

TEST(LocalizerSearch, AStartWithoutAPoseIsFound) {
  for (const std::string method : {"weighted", "classical"}) {
    SCOPED_TRACE(method);
    const LocalizerOptions options = optionsOf(method);
    Localizer localizer(streetMap(options.method.segment), options);
    unsigned seed = 20;
    for (const Eigen::Isometry3d& T_map_lidar : testPoses()) {
      localizer.setUnknownPose();
      EXPECT_EQ(localizer.track().status, TrackStatus::LOST);
      EXPECT_FALSE(localizer.track().pose_known);
      const std::vector<LidarPoint> scan = scanBlocks(streetBlocks(), sensor(), T_map_lidar, seed++);
      const LocalizationResult result = localizer.localize(viewOf(scan), 0.0);
      ASSERT_TRUE(result.accepted()) << toString(result.acceptance) << T_map_lidar.matrix();
      EXPECT_EQ(result.search, SearchExtent::EVERYWHERE);
      EXPECT_TRUE(isAt(result.T_map_base, T_map_lidar, 0.03, 0.1));
      EXPECT_TRUE(result.track.pose_known);
      EXPECT_FALSE(result.track.velocity_known);
    }
  }
}

TEST(LocalizerSearch, PlacesThatLookAlikeAreNotTakenForEachOther) {
  const Eigen::Vector3d copy_at(256.0, 0.0, 0.0);
  const LocalizerOptions options = optionsOf("weighted");
  Localizer localizer(streetMap(true, {Eigen::Vector3d::Zero(), copy_at}), options);
  const std::vector<LidarPoint> scan = scanBlocks(streetBlocks(), sensor(), testPoses()[1], 40);
  localizer.setUnknownPose();
  LocalizationResult result = localizer.localize(viewOf(scan), 0.0);
  EXPECT_EQ(result.acceptance, Acceptance::AMBIGUOUS);
  EXPECT_FALSE(result.track.pose_known);
  // A rough position decides, and so does a pose.
  ScanPriors priors;
  priors.position.emplace();
  priors.position->position_m = testPoses()[1].translation() + copy_at + Eigen::Vector3d(3.0, -2.0, 1.0);
  priors.position->covariance.diagonal().setConstant(4.0);
  result = localizer.localize(viewOf(scan), 0.1, priors);
  ASSERT_TRUE(result.accepted()) << toString(result.acceptance);
  EXPECT_EQ(result.search, SearchExtent::AROUND);
  Eigen::Isometry3d T_expected = testPoses()[1];
  T_expected.translation() += copy_at;
  EXPECT_TRUE(isAt(result.T_map_base, T_expected, 0.03, 0.1));
  localizer.setInitialPose(streetPose(-3.0, -2.0, 60.0));
  result = localizer.localize(viewOf(scan), 0.2);
  ASSERT_TRUE(result.accepted()) << toString(result.acceptance);
  EXPECT_TRUE(isAt(result.T_map_base, testPoses()[1], 0.03, 0.1));
}

TEST(LocalizerSearch, ACarriedVehicleIsFoundOnceItIsLost) {
  const LocalizerOptions options = optionsOf("weighted");
  Localizer localizer(streetMap(true), options);
  const std::vector<LidarPoint> before = scanBlocks(streetBlocks(), sensor(), testPoses()[0], 50);
  const std::vector<LidarPoint> after = scanBlocks(streetBlocks(), sensor(), testPoses()[3], 51);
  localizer.setInitialPose(testPoses()[0]);
  for (const double stamp_s : {0.0, 0.1, 0.2}) ASSERT_TRUE(localizer.localize(viewOf(before), stamp_s).accepted());
  LocalizationResult result;
  int rejected = 0;
  for (double stamp_s = 0.3; stamp_s < 1.0; stamp_s += 0.1) {
    result = localizer.localize(viewOf(after), stamp_s);
    if (result.accepted()) break;
    ++rejected;
  }
  ASSERT_TRUE(result.accepted()) << toString(result.acceptance);
  EXPECT_LE(rejected, options.prediction.lost_after_scans);
  EXPECT_EQ(result.search, SearchExtent::EVERYWHERE);
  EXPECT_TRUE(isAt(result.T_map_base, testPoses()[3], 0.03, 0.1));
}

TEST(LocalizerSearch, ASearchGoesOnBesideTheScansThatItsBudgetIsTooShortFor) {
  LocalizerOptions options = optionsOf("weighted");
  options.search_budget_ms = 1e-3;
  Localizer localizer(streetMap(true), options);
  localizer.setUnknownPose();
  const Eigen::Isometry3d T_map_lidar = testPoses()[2];
  const std::vector<LidarPoint> scan = scanBlocks(streetBlocks(), sensor(), T_map_lidar, 52);
  LocalizationResult result = localizer.localize(viewOf(scan), 0.0);
  EXPECT_FALSE(result.accepted());
  EXPECT_FALSE(result.track.pose_known);
  EXPECT_EQ(result.search, SearchExtent::EVERYWHERE);
  int scans = 1;
  for (; !result.accepted() && scans < 1000; ++scans) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    result = localizer.localize(viewOf(scan), 1e-3 * scans);
    EXPECT_TRUE(result.T_map_base.matrix().allFinite());
    if (!result.accepted() && result.track.pose_known) {
      // Found, but at an earlier scan: the next one is aligned from there.
      EXPECT_EQ(result.track.status, TrackStatus::COASTING);
      EXPECT_TRUE(isAt(result.T_map_base, T_map_lidar, 0.03, 0.1));
    }
  }
  ASSERT_TRUE(result.accepted()) << toString(result.acceptance);
  EXPECT_GT(scans, 2);
  EXPECT_TRUE(isAt(result.T_map_base, T_map_lidar, 0.03, 0.1));
  // A search whose vehicle has been found otherwise is of no account.
  localizer.setUnknownPose();
  localizer.localize(viewOf(scan), 2.0);
  localizer.setInitialPose(T_map_lidar);
  EXPECT_TRUE(localizer.localize(viewOf(scan), 2.1).accepted());
}

TEST(LocalizerSearch, WithoutSearchALostVehicleStaysLost) {
  LocalizerOptions options = optionsOf("weighted");
  options.search = false;
  Localizer localizer(streetMap(true), options);
  expectThrows<std::logic_error>([&] { localizer.setUnknownPose(); }, {"setUnknownPose"});
  Localizer with_own_aligner([](const SourcePoints&, const Eigen::Isometry3d&) { return AlignmentResult(); },
                             optionsOf("weighted"));
  expectThrows<std::logic_error>([&] { with_own_aligner.setUnknownPose(); }, {"setUnknownPose"});
}

TEST(LocalizerSearch, OutliersOfAMeasuredPositionMoveNothing) {
  const LocalizerOptions options = optionsOf("weighted");
  const WeightedVoxelMap map = streetMap(true);
  Localizer with(map, options), without(map, options);
  unsigned seed = 60;
  for (Localizer* const localizer : {&with, &without}) localizer->setInitialPose(streetPose(-5.0, 0.0, 0.0));
  for (int i = 0; i < 6; ++i) {
    const Eigen::Isometry3d T_map_lidar = streetPose(-5.0 + 0.8 * i, 0.0, 0.0);
    const std::vector<LidarPoint> scan = scanBlocks(streetBlocks(), sensor(), T_map_lidar, seed++);
    ScanPriors priors;
    priors.position.emplace();
    priors.position->position_m = T_map_lidar.translation() + Eigen::Vector3d(i == 3 ? 30.0 : 2.0, -1.5, 1.0);
    priors.position->covariance.diagonal().setConstant(4.0);
    const LocalizationResult expected = without.localize(viewOf(scan), 0.1 * i);
    const LocalizationResult result = with.localize(viewOf(scan), 0.1 * i, priors);
    ASSERT_TRUE(expected.accepted() && result.accepted()) << i;
    // The iteration starts elsewhere and ends within its epsilon of 1 mm.
    EXPECT_LT((result.T_map_base.translation() - expected.T_map_base.translation()).norm(), 1e-3);
  }
}

}  // namespace
}  // namespace saw_ndt
