#include "report/benchmark.h"

#include <gtest/gtest.h>

#include <atomic>

#include "expect_throws.h"
#include "localization/synthetic_drive.h"
#include "report/scan_errors.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/drives/kitti_sequence.h"
#include "temporary_folder.h"

namespace saw_ndt {

using namespace internal;

namespace {

class BenchmarkTest : public ::testing::Test {
 protected:
  BenchmarkTest() {
    writeKittiDrive(folder.path() / "first", driveDownTheStreet(sensor, 6));
    writeKittiDrive(folder.path() / "second", driveDownTheStreet(sensor, 8));
    options.skip_s = 0.2;
    options.localizer.segmentation.sensor = sensor;
    options.localizer.alignment.threads = 1;
  }

  std::shared_ptr<const Recording> drive(const std::string& name) const {
    return std::make_shared<KittiSequence>(folder.path() / name);
  }
  void expectRefused(std::vector<BenchmarkDrive> drives, std::initializer_list<std::string> parts) const {
    expectThrows<std::invalid_argument>([&] { Benchmark(std::move(drives), options); }, parts);
  }

  TemporaryFolder folder;
  const SensorModel sensor = SensorModel::named("VLP-16");
  BenchmarkOptions options;
};

TEST_F(BenchmarkTest, EveryMethodOnEveryDriveInBothMaps) {
  options.methods = {"weighted", "classical", "pcl-ndt"};
  options.drives = {MapDrive::SAME, MapDrive::OTHER};
  options.scans = "::3";
  const Benchmark benchmark({{drive("first"), drive("second")}, {drive("second"), drive("first")}}, options);
  std::vector<std::string> stages;
  std::size_t steps_announced = 0;
  std::atomic<std::size_t> steps_done{0};
  const auto begin = [&](const std::string& description, std::size_t steps) {
    EXPECT_EQ(steps_done, steps_announced);
    stages.push_back(description);
    steps_announced += steps;
  };
  const std::vector<BenchmarkRun> runs = benchmark.run({begin, [&] { ++steps_done; }});
  EXPECT_EQ(stages.size(), benchmark.stageCount());
  EXPECT_EQ(steps_done, steps_announced);
  EXPECT_EQ(stages[0], "first, same drive: building the map from 6 scans");
  EXPECT_EQ(stages[1], "first, same drive: giving PCL the points of 6 scans");
  EXPECT_EQ(stages[2], "first, same drive: localizing 2 scans by 3 methods");
  EXPECT_EQ(stages[6], "first, other drive: building the map from 8 scans");

  ASSERT_EQ(runs.size(), 4U);
  EXPECT_EQ(runs[1].sequence, "second");
  EXPECT_EQ(runs[2].drive, MapDrive::OTHER);
  EXPECT_EQ(runs[2].map_scans, 8U);
  for (const BenchmarkRun& run : runs) {
    EXPECT_FALSE(run.voxels.empty());
    ASSERT_EQ(run.cells.size(), 3U);
    for (std::size_t m = 0; m < run.cells.size(); ++m) {
      const BenchmarkCell& cell = run.cells[m];
      EXPECT_EQ(cell.method, options.methods[m]);
      EXPECT_EQ(cell.summary.method, cell.method);
      EXPECT_EQ(cell.summary.accepted, run.T_map_base.size());
      EXPECT_EQ(cell.run.scans[1], 3);
      // PCL does not find its way from scan to scan, 1.5 m apart, while the velocity is not known.
      if (cell.method != kPclNdtMethod) {
        EXPECT_LT(cell.summary.metrics->position_max_m, 0.05) << cell.method;
      }
      EXPECT_GT(cell.summary.likelihood_mean, 0.5) << cell.method;
      EXPECT_GT(cell.summary.nearest_voxel_likelihood_mean, 0.5) << cell.method;
      EXPECT_GT(cell.summary.align_ms.mean, 0.0);
      EXPECT_EQ(cell.summary.metrics->evaluated_scans, run.T_map_base.size() - 1);  // the first is at 0 s
    }
  }
}

TEST_F(BenchmarkTest, AMethodDoesNotDependOnTheOthers) {
  options.methods = {"classical", "weighted"};
  const BenchmarkRun both = Benchmark({{drive("first"), {}}}, options).run().front();
  options.methods = {"weighted"};
  const BenchmarkRun alone = Benchmark({{drive("first"), {}}}, options).run().front();
  for (std::size_t i = 0; i < alone.T_map_base.size(); ++i) {
    EXPECT_EQ(alone.cells[0].run.results[i].T_map_base.matrix(), both.cells[1].run.results[i].T_map_base.matrix());
  }
}

TEST_F(BenchmarkTest, MethodsTakeTurnsAnotherOneFirstEachTime) {
  std::string order;
  const auto named = [&](char name) {
    return [&order, name](const ScanView&, double stamp_s, const ScanPriors&) {
      order += name;
      LocalizationResult result;
      result.stamp_s = stamp_s;
      return result;
    };
  };
  const auto runs = localizeByTurns({named('a'), named('b'), named('c')}, *drive("first")->scans({1, 3, 4, 5}));
  EXPECT_EQ(order, "abcbcacababc");
  ASSERT_EQ(runs.size(), 3U);
  for (const DriveLocalization& run : runs) {
    ASSERT_EQ(run.results.size(), 4U);
    EXPECT_EQ(run.scans, (std::vector<int>{1, 3, 4, 5}));
    EXPECT_NEAR(run.results[1].stamp_s, 0.3, 1e-12);
  }
}

TEST_F(BenchmarkTest, RefusesBeforeTheWork) {
  options.skip_s = 3.0;
  expectRefused({{drive("first"), {}}}, {"skip_s = 3", "first", "lower -skip"});
  options.skip_s = 0.0;
  expectRefused({}, {"drives", "none"});
  expectRefused({{drive("first"), {}}, {drive("first"), {}}}, {"names of the drives", "twice"});
  options.drives = {MapDrive::OTHER};
  expectRefused({{drive("first"), {}}}, {"first", "no other drive"});
  options.drives = {MapDrive::SAME};
  options.map_scans = "7";
  expectRefused({{drive("first"), {}}}, {"'7'"});
  options.map_scans = ":";
  options.methods = {"weighted", "best"};
  expectRefused({{drive("first"), {}}}, {"method = best", "classical", "pcl-ndt"});
  options.methods = {"weighted", "weighted"};
  expectRefused({{drive("first"), {}}}, {"methods", "twice"});
  options.methods = {"weighted"};
  options.resolution_m = 0.0;
  expectRefused({{drive("first"), {}}}, {"resolution_m = 0"});
  options.resolution_m = 1.0;
  std::filesystem::remove(folder.path() / "first" / "poses.txt");
  expectThrows<Error>([&] { Benchmark({{drive("first"), {}}}, options); }, {"first", "poses.txt", "no poses"});
  options.drives = {MapDrive::OTHER};
  expectThrows<Error>([&] { Benchmark({{drive("second"), drive("first")}}, options); }, {"first", "no poses"});
}

TEST(ScanErrors, HandComputed) {
  BenchmarkRun run;
  for (const double x : {0.0, 3.0, 7.0}) {
    run.T_map_base.push_back(Eigen::Isometry3d(Eigen::Translation3d(x, 0, 0)));
  }
  BenchmarkCell cell{"weighted", {}, {}};
  for (int i = 0; i < 3; ++i) {
    LocalizationResult result;
    result.stamp_s = 10.0 + 0.1 * i;
    result.T_map_base = run.T_map_base[static_cast<std::size_t>(i)] *
                        transformFromXyzRpy((Vector6d() << 0, 3.0 * i, 4.0 * i, 0, 0, -0.5 * i).finished());
    cell.run.results.push_back(result);
  }
  run.cells.push_back(cell);
  const ScanErrors errors = scanErrors(run, cell);
  EXPECT_NEAR(errors.position_error_m[1], 5.0, 1e-12);
  EXPECT_NEAR(errors.position_error_m[2], 10.0, 1e-12);
  EXPECT_NEAR(errors.yaw_error_deg[2], degreesFromRadians(1.0), 1e-9);
  EXPECT_EQ(distancesDriven(run), (std::vector<double>{0.0, 3.0, 7.0}));
  EXPECT_EQ(distanceSkipped(run), 0.0);
  run.skip_s = 0.15;
  EXPECT_EQ(distanceSkipped(run), 3.0);
}

}  // namespace
}  // namespace saw_ndt
