#include <gtest/gtest.h>
#include <sys/resource.h>

#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include "adversarial_clouds.h"
#include "localization/scans_in_memory.h"
#include "localization/source_voxel_filter.h"
#include "saw_ndt/drives/drive_map.h"
#include "saw_ndt/localization/localizer.h"

namespace saw_ndt {

using namespace internal;

namespace {

using Scan = std::vector<LidarPoint>;

constexpr std::size_t kBadScan = 5;
constexpr std::size_t kScans = 10;

/// Whether a pose is where a cloud was taken: the street's from the first scan's pose, be it that it looks back.
bool isWhereTaken(const AdversarialCloud& cloud, const Eigen::Isometry3d& T_map_base) {
  const std::string name = cloud.name;
  const bool is_back = name == "Backwards";
  if (!is_back && name != "Twice" && name != "Shuffled" && name != "AmongGarbage") return false;
  const Eigen::Vector3d turned(0.0, 0.0, is_back ? kPi : 0.0);
  return T_map_base.translation().norm() < 0.05 &&
         rotationAngle(rotationFromVector(-turned) * T_map_base.linear()) < 0.005;
}

/// A drive in the map of its even scans.
class MappedDrive {
 protected:
  explicit MappedDrive(const std::string& method) {
    sensor.columns = 450;
    drive = driveDownTheStreet(sensor, kScans);
    options.method = LocalizationMethod::named(method);
    options.segmentation.sensor = sensor;
    const SyntheticDrive even = evenScansOf(drive);
    DriveMapOptions map_options;
    map_options.segmentation = options.segmentation;
    ScansInMemory map_scans(even);
    target = NdtTarget(buildDriveMap(map_scans, map_options).build(), options.method.voxels);
  }

  /// How far a pose is from that of a scan (m, at kRotationArm_m for rotations).
  double errorOf(const Eigen::Isometry3d& T_map_base, std::size_t scan) const {
    const Eigen::Isometry3d off = drive.T_map_lidar[scan].inverse() * T_map_base;
    return std::max(off.translation().norm(), kRotationArm_m * rotationAngle(off.linear()));
  }

  /// Expects that poses are as they should be, and told by their covariance, whatever scan kBadScan was.
  void expectFollowed(Localizer& localizer, const AdversarialCloud& bad_scan) const {
    for (std::size_t scan = 1; scan < kScans; scan += 2) {
      const Scan points = scan == kBadScan ? bad_scan.points() : drive.scans[scan];
      const LocalizationResult result = localizer.localize(viewOf(points), drive.stamps_s[scan]);
      EXPECT_TRUE(result.T_map_base.matrix().allFinite()) << scan;
      EXPECT_TRUE(result.covariance.allFinite()) << scan;
      EXPECT_TRUE(result.accepted() || scan == kBadScan) << scan << ": " << toString(result.acceptance);
      if (scan == kBadScan && isWhereTaken(bad_scan, result.T_map_base)) continue;
      // The motion is a circle at constant speed, which the prediction follows from poses that are right to 1 cm.
      EXPECT_LT(errorOf(result.T_map_base, scan), 0.05) << scan << ": " << toString(result.acceptance);
    }
    EXPECT_EQ(localizer.track().status, TrackStatus::TRACKING);
  }

  SensorModel sensor = SensorModel::named("VLP-16");
  SyntheticDrive drive;
  LocalizerOptions options;
  NdtTarget target;
};

/// By each method; the clouds in a few parts, so that none takes long.
class AdversarialScanOfADrive : protected MappedDrive, public testing::TestWithParam<std::tuple<const char*, int>> {
 protected:
  static constexpr int kParts = 3;

  AdversarialScanOfADrive() : MappedDrive(std::get<0>(GetParam())) {
    const std::vector<AdversarialCloud> all = adversarialClouds();
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (i % kParts == static_cast<std::size_t>(std::get<1>(GetParam()))) clouds.push_back(all[i]);
    }
  }

  std::vector<AdversarialCloud> clouds;
};

TEST_P(AdversarialScanOfADrive, InTheMiddleNeitherMovesThePoseNorLosesIt) {
  for (const AdversarialCloud& cloud : clouds) {
    SCOPED_TRACE(cloud.name);
    Localizer localizer(target, options);
    localizer.setInitialPose(drive.T_map_lidar[1]);
    expectFollowed(localizer, cloud);
  }
}

TEST_P(AdversarialScanOfADrive, AtAnUnknownStartIsLocatedWhereItWasTakenAlone) {
  for (const AdversarialCloud& cloud : clouds) {
    SCOPED_TRACE(cloud.name);
    Localizer localizer(target, options);
    localizer.setUnknownPose();
    const LocalizationResult first = localizer.localize(viewOf(cloud.points()), drive.stamps_s[1]);
    EXPECT_TRUE(first.T_map_base.matrix().allFinite());
    EXPECT_TRUE(first.covariance.allFinite());
    EXPECT_EQ(first.accepted(), isWhereTaken(cloud, first.T_map_base)) << first.T_map_base.matrix();
    const LocalizationResult next = localizer.localize(viewOf(drive.scans[3]), drive.stamps_s[3]);
    EXPECT_LT(next.accepted() ? errorOf(next.T_map_base, 3) : 0.0, 0.05) << toString(next.acceptance);
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, AdversarialScanOfADrive,
                         testing::Combine(testing::Values("weighted", "classical"), testing::Values(0, 1, 2)));

class DriveOfOddStamps : protected MappedDrive, public testing::TestWithParam<const char*> {
 protected:
  DriveOfOddStamps() : MappedDrive(GetParam()) {}
};

TEST_P(DriveOfOddStamps, OfWhichOneIsOddGoesOn) {
  constexpr double kLeast = std::numeric_limits<double>::denorm_min(), kMost = std::numeric_limits<double>::max();
  for (const double odd_s : {kLeast, -kLeast, 1e300, -1e300, kMost, -kMost, 0.3, 0.3 - 1e-9, 0.3 + 1e-9, 1e-300}) {
    SCOPED_TRACE(odd_s);
    Localizer localizer(target, options);
    localizer.setInitialPose(drive.T_map_lidar[1]);
    for (std::size_t scan = 1; scan < kScans; scan += 2) {
      const double stamp_s = scan == kBadScan ? odd_s : drive.stamps_s[scan];
      const LocalizationResult result = localizer.localize(viewOf(drive.scans[scan]), stamp_s);
      EXPECT_TRUE(result.T_map_base.matrix().allFinite()) << scan;
      EXPECT_TRUE(result.covariance.allFinite()) << scan;
      EXPECT_TRUE(result.track.velocity_base_mps.allFinite()) << scan;
      if (scan != kBadScan) {
        EXPECT_TRUE(result.accepted()) << scan << ": " << toString(result.acceptance);
        EXPECT_LT(errorOf(result.T_map_base, scan), 0.05) << scan;
      }
    }
  }
}

TEST_P(DriveOfOddStamps, IsFollowed) {
  const auto followed = [&](const auto& stampOf) {
    Localizer localizer(target, options);
    localizer.setInitialPose(drive.T_map_lidar[1]);
    for (std::size_t scan = 1; scan < kScans; scan += 2) {
      const LocalizationResult result = localizer.localize(viewOf(drive.scans[scan]), stampOf(scan));
      EXPECT_TRUE(result.accepted()) << scan << ": " << toString(result.acceptance);
      EXPECT_LT(errorOf(result.T_map_base, scan), 0.05) << scan;
    }
  };
  constexpr double kLeast = std::numeric_limits<double>::denorm_min();
  followed([&](std::size_t scan) { return kLeast * static_cast<double>(scan); });
  followed([&](std::size_t) { return 1e300; });
  followed([&](std::size_t scan) { return 1e290 * static_cast<double>(scan); });
  followed([&](std::size_t scan) { return scan % 4 == 1 ? 1e300 : -1e300; });
}

INSTANTIATE_TEST_SUITE_P(Methods, DriveOfOddStamps, testing::Values("weighted", "classical"));

/// The greatest memory of the process so far (bytes).
std::size_t peakBytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

TEST(AdversarialSize, FiveMillionPointsAreSegmentedThinnedAndMapped) {
  constexpr std::size_t kPoints = 5000000;
  Scan scan(kPoints);
  // A linear congruence: a good generator takes longer than all that is tested.
  std::uint32_t state = 1;
  const auto next = [&state] { return static_cast<float>((state = 1664525U * state + 1013904223U) >> 8) * 0x1p-24F; };
  for (LidarPoint& point : scan) point = {120.0F * next() - 60.0F, 120.0F * next() - 60.0F, 6.0F * next() - 2.0F, 0.5F};
  const std::size_t before = peakBytes();
  ScanPreparationOptions options;
  ScanPreparation preparation(options);
  const SourcePoints& source = preparation.prepare(viewOf(scan));
  EXPECT_LE(source.size(), kPoints);
  EXPECT_LT((peakBytes() - before) / kPoints, 100U);
  WeightedMapBuilder builder(1.0);
  builder.addScan(viewOf(scan), {}, Eigen::Isometry3d::Identity(), 2);
  EXPECT_EQ(builder.origin().point_count, kPoints);
  EXPECT_LE(builder.entryCount(), 120U * 120U * 6U);
  EXPECT_LT((peakBytes() - before) / kPoints, 150U);
}

}  // namespace
}  // namespace saw_ndt
