#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "real_data.h"
#include "report/scan_statistics.h"
#include "saw_ndt/drives/kitti_sequence.h"
#include "saw_ndt/pcl/cloud_view.h"
#include "simulation/lidar_simulator.h"
#include "simulation/short_drive.h"

namespace saw_ndt {
namespace {

struct Span {
  double least = 1e300, greatest = -1e300;
};

std::map<std::string, Span> spansOfRealScans(const std::filesystem::path& sequences, ScanSegmenter& segmenter) {
  std::map<std::string, Span> spans;
  for (const char* name : {"00", "01", "03", "drive_0005"}) {
    const KittiSequence sequence(sequences / name);
    for (int scan = 0; scan < sequence.scanCount(); scan += 3) {
      const auto cloud = sequence.readScan(scan);
      for (const auto& [figure, value] : scanStatistics(viewOf(cloud), {}, segmenter)) {
        Span& span = spans[figure];
        span.least = std::min(span.least, value);
        span.greatest = std::max(span.greatest, value);
      }
    }
  }
  return spans;
}

// Single scans vary within a drive; what docs/simulation.md compares are medians, which lie nearer.
TEST(Realism, SimulatedScansLookLikeRealOnes) {
  if (realDataFolder().empty()) GTEST_SKIP() << "no real scans";
  ScanSegmenter segmenter;
  const auto spans = spansOfRealScans(realDataFolder() / "kitti" / "sequences", segmenter);
  for (const char* name : {"residential", "highway", "rural"}) {
    const SimulatedDrive drive = shortDrive(name, {}, 62);
    LidarSimulator simulator(drive.scene, LidarOptions());
    const LidarScan scan = simulator.scan(*drive.motion, 60);
    for (const auto& [figure, value] : scanStatistics(viewOf(scan.points), scan.semantic_classes, segmenter)) {
      const auto span = spans.find(figure);
      if (span == spans.end()) continue;
      EXPECT_GT(value, 0.75 * span->second.least) << name << ": " << figure;
      EXPECT_LT(value, 1.25 * span->second.greatest) << name << ": " << figure;
    }
  }
}

}  // namespace
}  // namespace saw_ndt
