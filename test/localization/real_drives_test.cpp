#include <gtest/gtest.h>

#include <iostream>
#include <memory>
#include <numeric>
#include <string>

#include "real_data.h"
#include "report/localization_summary.h"
#include "saw_ndt/drives/drive_map.h"
#include "saw_ndt/drives/kitti_sequence.h"
#include "saw_ndt/drives/scan_selection.h"

namespace saw_ndt {
namespace {

/// A real drive: a map of some of its scans, and methods that localize others in it.
class RealDrive {
 public:
  RealDrive(const std::string& name, const std::string& map_scans, double resolution_m = DriveMapOptions().resolution_m)
      : sequence_(realDataFolder() / "kitti" / "sequences" / name), reference_(sequence_.posesLidar()) {
    DriveMapOptions options;
    options.resolution_m = resolution_m;
    map_ = buildDriveMap(*sequence_.scans(selected(map_scans)), options).build();
  }

  DriveLocalization localize(const std::string& method, const std::string& scans, int threads,
                             LocalizationSummary& summary) const {
    LocalizerOptions options;
    options.method = LocalizationMethod::named(method);
    options.alignment.threads = threads;
    Localizer localizer(map_, options);
    const std::vector<int> numbers = selected(scans);
    localizer.setInitialPose(reference_[static_cast<std::size_t>(numbers.front())]);
    DriveLocalization run = localizeDrive(localizer, *sequence_.scans(numbers));
    summary = summarize(run, localizer.options(), 0.0);
    return run;
  }

  /// The errors of a method, all of whose scans must be accepted.
  TrajectoryMetrics errorsOf(const std::string& method, const std::string& scans) const {
    LocalizationSummary summary;
    localize(method, scans, 0, summary);
    EXPECT_EQ(summary.rejected, 0U);
    EXPECT_EQ(summary.metrics->evaluated_scans, summary.scans);
    std::cout << sequence_.name() << ' ' << scans << ' ' << method << ": ATE " << summary.metrics->ate_rmse_m
              << " m, max " << summary.metrics->position_max_m << " m, yaw MAE " << summary.metrics->yaw_mae_deg
              << " deg, " << summary.rejected << " rejected\n";
    return *summary.metrics;
  }

 private:
  std::vector<int> selected(const std::string& scans) const { return parseScanSelection(scans, sequence_.scanCount()); }

  KittiSequence sequence_;
  std::vector<Eigen::Isometry3d> reference_;
  WeightedVoxelMap map_;
};

struct Bounds {
  double ate_m, max_m, yaw_mae_deg;
};

void expectWithin(const TrajectoryMetrics& errors, const Bounds& bounds) {
  EXPECT_LE(errors.ate_rmse_m, bounds.ate_m);
  EXPECT_LE(errors.position_max_m, bounds.max_m);
  EXPECT_LE(errors.yaw_mae_deg, bounds.yaw_mae_deg);
}

class RealDrives : public ::testing::Test {
 protected:
  void SetUp() override {
    if (realDataFolder().empty()) GTEST_SKIP() << "no real scans: set SAW_NDT_DATA to their folder";
  }
};

// One test, so that each map is built once.
TEST_F(RealDrives, AccuracyOnFourClips) {
  double weighted_sum_m = 0.0, classical_sum_m = 0.0;
  {
    const RealDrive drive("drive_0005", "0:70:2");
    for (const std::string scans : {"1:70:2", "1:70:6", "1:70:10"}) {
      SCOPED_TRACE("drive_0005 " + scans);
      const TrajectoryMetrics classical = drive.errorsOf("classical", scans);
      expectWithin(classical, {0.0045, 0.010, 0.0045});
      expectWithin(drive.errorsOf("weighted-s50", scans), {0.0050, 0.012, 0.0055});
      const TrajectoryMetrics weighted = drive.errorsOf("weighted", scans);
      if (scans != "1:70:2") continue;
      EXPECT_LE(weighted.ate_rmse_m, classical.ate_rmse_m);
      weighted_sum_m += weighted.ate_rmse_m;
      classical_sum_m += classical.ate_rmse_m;
    }
  }
  const struct {
    std::string name;
    double classical_ate_m, weighted_s50_ate_m;
  } clips[] = {{"00", 0.0030, 0.0030}, {"01", 0.0110, 0.0150}, {"03", 0.0050, 0.0070}};
  for (const auto& clip : clips) {
    SCOPED_TRACE(clip.name);
    const RealDrive drive(clip.name, "0:10:2");
    const double classical_m = drive.errorsOf("classical", "1:10:2").ate_rmse_m;
    EXPECT_LE(classical_m, clip.classical_ate_m);
    EXPECT_LE(drive.errorsOf("weighted-s50", "1:10:2").ate_rmse_m, clip.weighted_s50_ate_m);
    weighted_sum_m += drive.errorsOf("weighted", "1:10:2").ate_rmse_m;
    classical_sum_m += classical_m;
  }
  std::cout << "mean ATE of the four clips: weighted " << weighted_sum_m / 4 << " m, classical " << classical_sum_m / 4
            << " m\n";
  EXPECT_LE(weighted_sum_m, 0.97 * classical_sum_m);
}

TEST_F(RealDrives, AcceptanceDoesNotDependOnTheSizeOfVoxels) {
  for (const double resolution_m : {0.25, 0.5, 0.7, 1.0, 1.5, 2.0}) {
    SCOPED_TRACE(resolution_m);
    const RealDrive drive("drive_0005", "0:70:2", resolution_m);
    for (const std::string method : {"weighted", "classical"}) {
      // 2 m voxels are twice as coarse as the paper's.
      expectWithin(drive.errorsOf(method, "1:70:6"), {0.010, 0.020, 0.010});
    }
  }
}

// 12.6 degrees between two scans, a second apart: the limits of a correction grow with that time.
TEST_F(RealDrives, ATurnOnTheSpotInFewScansIsFollowed) {
  const std::filesystem::path folder = realDataFolder() / "sensors" / "sequences" / "mid360_turning";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no sequence mid360_turning in SAW_NDT_DATA";
  const KittiSequence sequence(folder);
  ASSERT_EQ(sequence.scanCount(), 11);
  std::vector<int> every_scan(11);
  std::iota(every_scan.begin(), every_scan.end(), 0);
  DriveMapOptions map_options;
  map_options.segmentation.reset();  // the sensor has no rings
  LocalizerOptions options;
  options.method = LocalizationMethod::named("classical");
  Localizer localizer(buildDriveMap(*sequence.scans(every_scan), map_options).build(), options);
  localizer.setInitialPose(sequence.posesLidar().front());
  const DriveLocalization run = localizeDrive(localizer, *sequence.scans(every_scan));
  for (std::size_t scan = 0; scan < run.results.size(); ++scan) {
    SCOPED_TRACE(scan);
    const LocalizationResult& result = run.results[scan];
    EXPECT_TRUE(result.accepted()) << toString(result.acceptance);
    // The reference is that of a SLAM: the first scan lies 3 cm beside the map of all, the others 1 cm.
    const Eigen::Isometry3d error = sequence.posesLidar()[scan].inverse() * result.T_map_base;
    EXPECT_LT(error.translation().norm(), scan == 0 ? 0.04 : 0.02);
    EXPECT_LT(degreesFromRadians(rotationAngle(error.linear())), 0.3);
  }
}

TEST_F(RealDrives, ThreadsDoNotChangeABit) {
  const RealDrive drive("drive_0005", "0:70:2");
  LocalizationSummary summary;
  const DriveLocalization expected = drive.localize("weighted", "1:70:10", 1, summary);
  for (const int threads : {2, 4}) {
    const DriveLocalization run = drive.localize("weighted", "1:70:10", threads, summary);
    for (std::size_t i = 0; i < run.results.size(); ++i) {
      EXPECT_TRUE(run.results[i].T_map_base.matrix() == expected.results[i].T_map_base.matrix()) << i;
      EXPECT_EQ(run.results[i].acceptance, expected.results[i].acceptance);
    }
  }
}

}  // namespace
}  // namespace saw_ndt
