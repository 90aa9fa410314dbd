#include "saw_ndt/localization/localizer.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <limits>
#include <memory>
#include <thread>
#include <vector>

#include "expect_throws.h"
#include "map/map_fixtures.h"
#include "registration/registration_fixtures.h"
#include "saw_ndt/pcl/cloud_view.h"

namespace saw_ndt {

using namespace internal;

namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

/// The street corner's points as a LiDAR at a pose sees them.
Cloud cornerSeenFrom(const Eigen::Isometry3d& T_map_lidar, unsigned seed) {
  Cloud scan;
  const Eigen::Isometry3f T_lidar_map = T_map_lidar.inverse().cast<float>();
  for (const pcl::PointXYZL& point : streetCorner(seed)) {
    const Eigen::Vector3f p = T_lidar_map * point.getVector3fMap();
    scan.push_back({p.x(), p.y(), p.z()});
  }
  return scan;
}

Eigen::Isometry3d planarPose(double x, double y, double yaw_deg) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << x, y, 0.0;
  T.linear() = rotationFromVector({0.0, 0.0, radiansFromDegrees(yaw_deg)});
  return T;
}

bool sameBits(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) { return a.matrix() == b.matrix(); }

void expectNear(const Eigen::Isometry3d& got, const Eigen::Isometry3d& expected, double metres, double degrees) {
  EXPECT_LT((got.translation() - expected.translation()).norm(), metres);
  EXPECT_LT(degreesFromRadians(rotationAngle(got.linear().transpose() * expected.linear())), degrees);
}

/// A vehicle that drives 0.2 m and turns 1 degree every 0.1 s, in a map of the corner.
class LocalizerTest : public ::testing::Test {
 protected:
  LocalizerTest() {
    options.method = LocalizationMethod::named("classical");
    options.alignment.threads = 1;
    map = NdtTarget(mapOf(withoutLabels(streetCorner(1))), options.method.voxels);
  }

  static Eigen::Isometry3d poseOf(int scan) { return planarPose(0.2 * scan - 0.6, 0.1 * scan, 1.0 * scan); }
  static Cloud scanOf(int scan) { return cornerSeenFrom(poseOf(scan), 100 + static_cast<unsigned>(scan)); }

  /// A localizer that has accepted scans 0 and 1.
  Localizer underWay(const LocalizerOptions& with) const {
    Localizer localizer(map, with);
    localizer.setInitialPose(poseOf(0));
    for (const int scan : {0, 1}) {
      EXPECT_TRUE(localizer.localize(viewOf(scanOf(scan)), 0.1 * scan).accepted());
    }
    return localizer;
  }

  /// Expects that a scan at 0.2 s is rejected for a reason, that its pose is the prediction, and that all goes on as if
  /// it had never come.
  void expectRejected(const Cloud& scan, Acceptance reason, const LocalizerOptions& with) const {
    Localizer localizer = underWay(with), undisturbed = underWay(with);
    const LocalizationResult rejected = localizer.localize(viewOf(scan), 0.2);
    EXPECT_EQ(rejected.acceptance, reason) << toString(rejected.acceptance);
    EXPECT_FALSE(rejected.accepted());
    EXPECT_EQ(rejected.stamp_s, 0.2);
    EXPECT_TRUE(sameBits(rejected.T_map_base, rejected.T_map_base_predicted));
    EXPECT_TRUE(rejected.T_map_base.matrix().allFinite());
    expectNear(rejected.T_map_base, poseOf(2), 0.05, 0.5);
    EXPECT_GT(rejected.covariance(0, 0), 0.0);
    EXPECT_EQ(rejected.free_directions.cols(), 0);

    const Cloud next = scanOf(3);
    const LocalizationResult after = localizer.localize(viewOf(next), 0.3);
    const LocalizationResult expected = undisturbed.localize(viewOf(next), 0.3);
    EXPECT_TRUE(after.accepted()) << toString(after.acceptance);
    EXPECT_TRUE(sameBits(after.T_map_base_predicted, expected.T_map_base_predicted));
    EXPECT_TRUE(sameBits(after.T_map_base, expected.T_map_base));
  }

  LocalizerOptions options;
  NdtTarget map;
};

TEST_F(LocalizerTest, FollowsADrive) {
  Localizer localizer(map, options);
  localizer.setInitialPose(poseOf(0) * planarPose(0.3, -0.2, 2.0));
  for (int scan = 0; scan < 8; ++scan) {
    const Cloud cloud = scanOf(scan);
    const LocalizationResult result = localizer.localize(viewOf(cloud), 0.1 * scan);
    SCOPED_TRACE(scan);
    ASSERT_TRUE(result.accepted()) << toString(result.acceptance);
    expectNear(result.T_map_base, poseOf(scan), 0.01, 0.1);
    EXPECT_TRUE(sameBits(result.T_map_base, result.alignment.T_map_source));
    const Eigen::Isometry3d correction = result.T_map_base_predicted.inverse() * result.T_map_base;
    EXPECT_DOUBLE_EQ(result.correction.distance_m, correction.translation().norm());
    EXPECT_DOUBLE_EQ(result.correction.angle_rad, rotationAngle(correction.linear()));
    EXPECT_LT(result.correction.distance_m, scan >= 2 ? 0.03 : 0.5);
    EXPECT_GT(result.source_points, 1000U);
    EXPECT_LT(result.source_points, cloud.size());
    // Every direction of the pose is held, and its error is what the covariance says.
    const Matrix6d& covariance = result.covariance;
    EXPECT_EQ(result.free_directions.cols(), 0);
    EXPECT_TRUE(covariance.isApprox(covariance.transpose(), 1e-6));
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix6d>(covariance).eigenvalues().minCoeff(), 0.0);
    const Vector6d error = poseDifference(poseOf(scan), result.T_map_base);
    EXPECT_LT(error.dot(covariance.inverse() * error), 22.5);
    EXPECT_GT(result.alignment.overlap, 0.8);
    EXPECT_EQ(result.times.segment_ms, 0.0);
    EXPECT_GE(result.times.total_ms, result.times.filter_ms + result.times.align_ms);
  }
}

TEST_F(LocalizerTest, ScansWithoutOverlapDoNotConverge) {
  expectRejected(Cloud(), Acceptance::NOT_CONVERGED, options);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Cloud only_nan;
  for (int i = 0; i < 5000; ++i) only_nan.push_back({nan, 1.0F, 2.0F});
  expectRejected(only_nan, Acceptance::NOT_CONVERGED, options);
  expectRejected(cornerSeenFrom(planarPose(900.0, -400.0, 0.0), 7), Acceptance::NOT_CONVERGED, options);
  expectRejected(cornerSeenFrom(planarPose(1e12, 0.0, 0.0), 7), Acceptance::NOT_CONVERGED, options);
}

TEST_F(LocalizerTest, NaNPointsOfAGoodScanDoNotMatter) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  Cloud scan = scanOf(2);
  Localizer clean = underWay(options), spoilt = underWay(options);
  const LocalizationResult expected = clean.localize(viewOf(scan), 0.2);
  for (int axis = 0; axis < 3; ++axis) {
    for (const float value : {nan, infinity, -infinity, 3e38F}) {
      pcl::PointXYZ point(1.0F, 1.0F, 1.0F);
      point.data[axis] = value;
      scan.push_back(point);
    }
  }
  const LocalizationResult result = spoilt.localize(viewOf(scan), 0.2);
  EXPECT_TRUE(result.accepted());
  EXPECT_EQ(result.source_points, expected.source_points);
  EXPECT_TRUE(sameBits(result.T_map_base, expected.T_map_base));
}

TEST_F(LocalizerTest, TheIterationLimitIsNoConvergence) {
  LocalizerOptions one_step = options;
  one_step.alignment.max_iterations = 1;
  one_step.alignment.use_coarse_level = false;
  Localizer localizer(map, one_step);
  localizer.setInitialPose(poseOf(0) * planarPose(0.3, 0.2, 1.0));
  const LocalizationResult result = localizer.localize(viewOf(scanOf(0)), 0.0);
  EXPECT_EQ(result.acceptance, Acceptance::NOT_CONVERGED);
  EXPECT_EQ(result.alignment.status, AlignmentStatus::ITERATION_LIMIT);
}

TEST_F(LocalizerTest, AScanMostlyOutsideOfTheMapIsRejected) {
  Cloud scan = scanOf(2);
  const std::size_t size = scan.size();
  for (std::size_t i = 0; i < size; ++i) {
    for (const float away_m : {200.0F, 400.0F, 600.0F, 800.0F, 1000.0F, 1200.0F}) {
      scan.push_back({scan[i].x + away_m, scan[i].y, scan[i].z});
    }
  }
  expectRejected(scan, Acceptance::LOW_OVERLAP, options);
  LocalizerOptions lenient = options;
  lenient.acceptance.min_overlap = 0.0;
  expectRejected(scan, Acceptance::LOW_LIKELIHOOD, lenient);
  lenient.acceptance.min_likelihood = 0.0;
  // Far less than usual it still is.
  expectRejected(scan, Acceptance::LOW_OVERLAP, lenient);
  lenient.acceptance.min_usual_overlap_share = 0.0;
  const LocalizationResult result = underWay(lenient).localize(viewOf(scan), 0.2);
  EXPECT_TRUE(result.accepted()) << toString(result.acceptance);
  EXPECT_LT(result.alignment.likelihoods.unweighted, options.acceptance.min_likelihood);
}

TEST_F(LocalizerTest, LargeCorrectionsAreRejected) {
  LocalizerOptions strict = options;
  strict.acceptance.max_correction_m = 0.3;
  strict.acceptance.max_correction_deg = 3.0;
  strict.prediction.max_turn_rate_radps = 0.3;
  const Cloud moved = cornerSeenFrom(poseOf(2) * planarPose(0.5, 0.0, 0.0), 8);
  const Cloud turned = cornerSeenFrom(poseOf(2) * planarPose(0.0, 0.0, 5.0), 9);
  expectRejected(moved, Acceptance::LARGE_TRANSLATION, strict);
  expectRejected(turned, Acceptance::LARGE_ROTATION, strict);
  for (const Cloud& scan : {moved, turned}) EXPECT_TRUE(underWay(options).localize(viewOf(scan), 0.2).accepted());
}

TEST_F(LocalizerTest, BeforeAVelocityIsKnownTheVehicleMayHaveMoved) {
  LocalizerOptions strict = options;
  strict.acceptance.max_correction_m = 0.3;
  for (const auto& [unknown_speed_mps, expected] :
       {std::pair(0.1, Acceptance::LARGE_TRANSLATION), std::pair(15.0, Acceptance::ACCEPTED)}) {
    strict.prediction.unknown_speed_sigma_mps = unknown_speed_mps;
    Localizer localizer(map, strict);
    localizer.setInitialPose(poseOf(0));
    EXPECT_TRUE(localizer.localize(viewOf(scanOf(0)), 0.0).accepted());
    EXPECT_EQ(localizer.localize(viewOf(scanOf(4)), 0.1).acceptance, expected);
  }
}

TEST_F(LocalizerTest, AnInitialPoseStartsAgain) {
  Localizer localizer = underWay(options);
  const Eigen::Isometry3d elsewhere = planarPose(-1.0, 1.5, 30.0);
  localizer.setInitialPose(elsewhere * planarPose(0.1, 0.1, 1.0));
  const LocalizationResult result = localizer.localize(viewOf(cornerSeenFrom(elsewhere, 11)), 5.0);
  EXPECT_TRUE(result.accepted());
  expectNear(result.T_map_base, elsewhere, 0.01, 0.1);
  EXPECT_TRUE(sameBits(result.T_map_base_predicted, elsewhere * planarPose(0.1, 0.1, 1.0)));
}

TEST_F(LocalizerTest, AMountedLidarGivesPosesOfTheBase) {
  options.T_base_lidar.translation() << 1.2, -0.3, 0.8;
  options.T_base_lidar.linear() = rotationFromVector({0.02, 0.1, 1.4});
  Localizer localizer(map, options);
  localizer.setInitialPose(poseOf(0));
  for (int scan = 0; scan < 6; ++scan) {
    const Cloud cloud = cornerSeenFrom(poseOf(scan) * options.T_base_lidar, 50 + static_cast<unsigned>(scan));
    const LocalizationResult result = localizer.localize(viewOf(cloud), 0.1 * scan);
    ASSERT_TRUE(result.accepted()) << toString(result.acceptance);
    expectNear(result.T_map_base, poseOf(scan), 0.01, 0.1);
  }
}

TEST_F(LocalizerTest, RefusesMapsThatDoNotFitTheMethod) {
  const auto refused = [&](const NdtTarget& with, const std::string& method, std::initializer_list<std::string> parts) {
    LocalizerOptions other = options;
    other.method = LocalizationMethod::named(method);
    expectThrows<std::invalid_argument>([&] { Localizer(with, other); }, parts);
  };
  const WeightedVoxelMap map_with_labels = mapOf(streetCorner(1));
  const NdtTarget labelled(map_with_labels), unlabelled(mapOf(withoutLabels(streetCorner(1))));
  EXPECT_NO_THROW(Localizer(NdtTarget(map_with_labels, LocalizerOptions().method.voxels), LocalizerOptions()));
  EXPECT_NO_THROW(Localizer(map_with_labels, LocalizerOptions()));
  refused(labelled, "weighted-s50", {"VoxelWeighting", "weighted-s50"});
  refused(labelled, "classical", {"VoxelWeighting", "classical"});
  refused(unlabelled, "weighted", {"labels", "weighted"});
}

TEST_F(LocalizerTest, ForgettingTheInitialPoseIsAnError) {
  Localizer localizer(map, options);
  EXPECT_EQ(localizer.track().status, TrackStatus::NOT_INITIALIZED);
  expectThrows<std::logic_error>([&] { localizer.localize(viewOf(scanOf(0)), 0.0); }, {"setInitialPose()"});
}

TEST_F(LocalizerTest, TheTrackIsToldWithEveryScan) {
  Localizer localizer = underWay(options);
  EXPECT_EQ(localizer.track().status, TrackStatus::TRACKING);
  EXPECT_TRUE(localizer.track().velocity_known);
  EXPECT_NEAR(localizer.track().velocity_base_mps.norm(), 2.24, 0.1);
  const LocalizationResult rejected = localizer.localize(viewOf(Cloud()), 0.2);
  EXPECT_EQ(rejected.track.status, TrackStatus::COASTING);
  EXPECT_EQ(rejected.track.rejected_scans, 1);
  EXPECT_TRUE(sameBits(rejected.track.T_map_base, localizer.track().T_map_base));
  const LocalizationResult accepted = localizer.localize(viewOf(scanOf(3)), 0.3);
  EXPECT_EQ(accepted.track.status, TrackStatus::TRACKING);
  EXPECT_EQ(accepted.track.rejected_scans, 0);
}

TEST_F(LocalizerTest, RefusesMapsOfOtherSegmentationUnlessAllowed) {
  WeightedMapBuilder builder(1.0, SegmentationOptions());
  addCloud(builder, streetCorner(1), Eigen::Isometry3d::Identity());
  const WeightedVoxelMap made_with = builder.build();
  LocalizerOptions other;
  EXPECT_NO_THROW(Localizer(made_with, other));
  other.segmentation.sensor = SensorModel::named("VLP-16");
  expectThrows<std::invalid_argument>([&] { Localizer(made_with, other); },
                                      {"segmentation.sensor", "VLP-16", "HDL-64E"});
  other.segmentation = {};
  other.segmentation.ground.slope_deg = 2.5;
  expectThrows<std::invalid_argument>([&] { Localizer(made_with, other); }, {"ground.slope_deg = 2.5", "with 10"});
  other.allow_other_segmentation = true;
  EXPECT_NO_THROW(Localizer(made_with, other));
  EXPECT_NO_THROW(Localizer(mapOf(streetCorner(1)), other)) << "of a map that does not know how it was made";
}

TEST_F(LocalizerTest, TakesMapsOfTheSameLidarMountedInAnotherWay) {
  WeightedMapBuilder builder(1.0, SegmentationOptions());
  addCloud(builder, streetCorner(1), Eigen::Isometry3d::Identity());
  LocalizerOptions other;
  other.segmentation.mounting_pitch_deg = 2.5;
  other.segmentation.mounting_roll_deg = 180.0;
  other.segmentation.ground.sensor_height_m = 1.2;
  other.segmentation.min_range_m = 2.0;
  other.segmentation.max_range_m = 80.0;
  other.segmentation.vehicle_box_m = {-2.0, -1.0, -2.0, 1.0, 1.0, 0.0};
  EXPECT_NO_THROW(Localizer(builder.build(), other));
}

TEST_F(LocalizerTest, TwoInTwoThreadsGiveTheSameBitsAsOneAfterTheOther) {
  options.alignment.threads = 2;
  const auto drive = [&](double offset_m) {
    Localizer localizer(map, options);
    localizer.setInitialPose(poseOf(0) * planarPose(offset_m, 0.0, 0.0));
    std::vector<Eigen::Isometry3d> poses;
    for (int scan = 0; scan < 8; ++scan) {
      poses.push_back(localizer.localize(viewOf(scanOf(scan)), 0.1 * scan).T_map_base);
    }
    return poses;
  };
  const double offsets_m[] = {0.1, -0.2};
  std::vector<Eigen::Isometry3d> expected[2], found[2];
  for (const int i : {0, 1}) expected[i] = drive(offsets_m[i]);
  std::vector<std::thread> threads;
  for (const int i : {0, 1}) threads.emplace_back([&, i] { found[i] = drive(offsets_m[i]); });
  for (std::thread& thread : threads) thread.join();
  for (const int i : {0, 1}) {
    ASSERT_EQ(found[i].size(), expected[i].size());
    for (std::size_t k = 0; k < expected[i].size(); ++k) EXPECT_TRUE(sameBits(found[i][k], expected[i][k])) << i << k;
  }
}

TEST_F(LocalizerTest, WrongOptionsNameTheirField) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [&](const std::string& field, auto change) {
    LocalizerOptions wrong = options;
    change(wrong);
    expectThrows<std::invalid_argument>([&] { wrong.check(); }, {field});
    expectThrows<std::invalid_argument>([&] { Localizer(map, wrong); }, {field});
  };
  for (const double value : {-1.0, nan}) {
    refused("min_likelihood", [&](LocalizerOptions& o) { o.acceptance.min_likelihood = value; });
    refused("max_correction_m", [&](LocalizerOptions& o) { o.acceptance.max_correction_m = value; });
    refused("max_correction_deg", [&](LocalizerOptions& o) { o.acceptance.max_correction_deg = value; });
    refused("min_overlap", [&](LocalizerOptions& o) { o.acceptance.min_overlap = value; });
    refused("min_advantage_sigmas", [&](LocalizerOptions& o) { o.acceptance.min_advantage_sigmas = value; });
    refused("unknown_speed_sigma_mps", [&](LocalizerOptions& o) { o.prediction.unknown_speed_sigma_mps = value; });
    refused("source_voxel_size_m", [&](LocalizerOptions& o) { o.source_voxel_size_m = value; });
    refused("ground_ratio", [&](LocalizerOptions& o) { o.method.ground_ratio = value; });
    refused("max_speed_mps", [&](LocalizerOptions& o) { o.prediction.max_speed_mps = value; });
    refused("translation_epsilon_m", [&](LocalizerOptions& o) { o.alignment.translation_epsilon_m = value; });
  }
  refused("max_iterations", [](LocalizerOptions& o) { o.alignment.max_iterations = 0; });
  refused("mounting_pitch_deg", [](LocalizerOptions& o) { o.segmentation.mounting_pitch_deg = 100.0; });
  refused("T_base_lidar", [&](LocalizerOptions& o) { o.T_base_lidar.translation().y() = nan; });
  refused("T_base_lidar", [&](LocalizerOptions& o) { o.T_base_lidar.linear() *= 2.0; });
  refused("T_base_lidar", [&](LocalizerOptions& o) { o.T_base_lidar.linear() *= -1.0; });
}

TEST_F(LocalizerTest, RefusesStampsThatAreNotFiniteAndInitialPosesThatAreNotRigid) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Localizer localizer = underWay(options);
  expectThrows<std::invalid_argument>([&] { localizer.localize(viewOf(scanOf(2)), nan); }, {"stamp_s"});
  expectThrows<std::invalid_argument>([&] { localizer.setInitialPose(planarPose(0.0, nan, 0.0)); }, {"T_map_base"});
  Eigen::Isometry3d scaled = poseOf(2), mirrored = poseOf(2);
  scaled.linear() *= 1.01;
  mirrored.linear().col(1) *= -1.0;
  for (const Eigen::Isometry3d& T : {scaled, mirrored}) {
    expectThrows<std::invalid_argument>([&] { localizer.setInitialPose(T); }, {"T_map_base", "rigid"});
  }
  EXPECT_TRUE(localizer.localize(viewOf(scanOf(2)), 0.2).accepted());
}

TEST_F(LocalizerTest, RefusesMeasurementsOfOtherSensorsThatAreNone) {
  Localizer localizer = underWay(options);
  const auto refuses = [&](const ScanPriors& priors, const char* field) {
    expectThrows<std::invalid_argument>([&] { localizer.localize(viewOf(scanOf(2)), 0.2, priors); }, {field});
  };
  for (const double variance : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    ScanPriors position, motion;
    position.position.emplace().covariance.diagonal().setConstant(variance);
    motion.motion.emplace().covariance.diagonal().setConstant(variance);
    refuses(position, "position.covariance");
    refuses(motion, "motion.covariance");
  }
  for (const double metres : {1e30, std::nan("")}) {
    ScanPriors far;
    far.position.emplace().position_m.x() = metres;
    refuses(far, "position");
  }
  EXPECT_TRUE(localizer.localize(viewOf(scanOf(2)), 0.2).accepted());
}

TEST(Acceptance, HasWords) {
  EXPECT_STREQ(toString(Acceptance::ACCEPTED), "accepted");
  EXPECT_STREQ(toString(Acceptance::NOT_CONVERGED), "not converged");
  EXPECT_STREQ(toString(Acceptance::LOW_LIKELIHOOD), "low likelihood");
  EXPECT_STREQ(toString(Acceptance::LARGE_TRANSLATION), "large translation");
  EXPECT_STREQ(toString(Acceptance::LARGE_ROTATION), "large rotation");
}

}  // namespace
}  // namespace saw_ndt
