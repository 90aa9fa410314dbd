#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "expect_throws.h"
#include "real_data.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/io/point_cloud_file.h"

namespace saw_ndt {
namespace {

class RealSensors : public ::testing::Test {
 protected:
  void SetUp() override {
    folder = realDataFolder() / "sensors";
    if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << "no real scans at " << folder;
  }

  std::filesystem::path folder;
};

TEST_F(RealSensors, AllThatTheirFilesTellIsRead) {
  const struct {
    const char* file;
    std::size_t points, height, rings;
    double span_s;  // 0: no times
  } files[] = {
      {"single/hdl32_padded.pcd", 58072, 1, 31, 0.0},
      {"single/livox_merged.pcd", 136269, 1, 0, 0.0},
      {"single/os0_128_lb_0.pcd", 131072, 128, 128, 0.1},
      {"single/os0_32_dual_0.pcd", 32768, 32, 32, 0.1},
      {"single/os1_64_staggered.pcd", 65536, 64, 64, 0.1},
      {"single/pandar64_street.pcd", 85546, 1, 64, 0.1},
      {"single/rs16_time_1.pcd", 29377, 1, 16, 0.1},
      {"single/rs16_time_2.pcd", 29710, 1, 16, 0.1},
      {"single/rs_m1_tilted_1.pcd", 78750, 15750, 0, 0.0},
      {"single/rs_m1_tilted_2.pcd", 78750, 15750, 0, 0.0},
      {"single/vlp16.pcd", 26926, 1, 16, 0.0},
      {"odd_forms/ascii_multi_count.pcd", 8, 1, 0, 0.0},
      {"odd_forms/ascii_with_underscore.pcd", 213, 1, 0, 0.0},
      {"odd_forms/binary_compressed_organized.pcd", 8, 2, 0, 0.0},
      {"odd_forms/double_xyz.pcd", 23546, 1, 32, 0.0},
      {"odd_forms/nuscenes_hdl32.pcd.bin", 34688, 1, 32, 0.0},
      {"odd_forms/width_0_height_0.pcd", 26585, 1, 0, 0.0},
      {"deskew/raw_00.pcd", 25109, 1, 0, 0.1},
      {"deskew/raw_01.pcd", 20061, 1, 0, 0.1},
      {"deskew/deskewed_00.pcd", 25109, 1, 0, 0.1},
      {"deskew/deskewed_01.pcd", 20061, 1, 0, 0.1},
      {"pairs/hdl32_source.pcd", 69792, 1, 0, 0.0},
      {"pairs/hdl32_target.pcd", 69088, 1, 0, 0.0},
  };
  for (const auto& file : files) {
    SCOPED_TRACE(file.file);
    const ScanPoints scan = readScanPoints(folder / file.file);
    EXPECT_EQ(scan.points.size(), file.points);
    EXPECT_EQ(scan.height, file.height);
    EXPECT_EQ(std::set<std::uint16_t>(scan.rings.begin(), scan.rings.end()).size(), file.rings);
    ASSERT_EQ(scan.times_s.empty(), file.span_s == 0.0);
    if (file.span_s > 0.0) {
      const auto [first, last] = std::minmax_element(scan.times_s.begin(), scan.times_s.end());
      EXPECT_NEAR(*last - *first, file.span_s, 0.001);
    }
    const auto cloud = readPointCloud<pcl::PointXYZI>(folder / file.file);
    ASSERT_EQ(cloud.size(), file.points);
    EXPECT_EQ(cloud.height, file.height);
    EXPECT_EQ(cloud.back().intensity, scan.points.back().intensity);
  }
  EXPECT_EQ(readScanPoints(folder / "single/vlp16_apollo_utm.pcd").points.size(), 24796U);
}

TEST_F(RealSensors, WhatIsNoScanIsRefusedInOneLine) {
  const std::pair<const char*, const char*> files[] = {
      {"odd_forms/ascii_invalid_header.pcd", "line 3"},
      {"odd_forms/nclt_uint16.bin", "points looked at have coordinates that no scan has"},
      {"odd_forms/ros2_cdr_pointcloud2.bin", "points looked at have coordinates that no scan has"}};
  for (const auto& [file, reason] : files) {
    SCOPED_TRACE(file);
    expectThrows<Error>([&, name = file] { readScanPoints(folder / name); }, {(folder / file).string(), reason});
    try {
      readScanPoints(folder / file);
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace saw_ndt
