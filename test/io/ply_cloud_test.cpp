#include "io/ply_cloud.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "expect_throws.h"
#include "io/pcd_text.h"
#include "real_data.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/io/point_cloud_file.h"
#include "saw_ndt/io/scan_file.h"
#include "temporary_folder.h"

namespace saw_ndt {
namespace {

constexpr char kVertices[] =
    "element vertex 2\nproperty double x\nproperty float y\nproperty float z\nproperty ushort ring\n"
    "property float scalar_intensity\nproperty uint t\n";

std::string headOf(const std::string& format, const std::string& before = "", const std::string& behind = "") {
  return "ply\nformat " + format + " 1.0\ncomment made by hand\n" + before + kVertices + behind + "end_header\n";
}

std::string binaryVertices(bool big_endian) {
  std::string bytes;
  const auto add = [&](double value, char type, int size) {
    std::string number = bytesOfNumber(value, type, size);
    if (big_endian) std::reverse(number.begin(), number.end());
    bytes += number;
  };
  for (const double i : {0.0, 1.0}) {
    add(1.25 + i, 'F', 8);
    add(-2.5, 'F', 4);
    add(3.0, 'F', 4);
    add(7.0 + 8.0 * i, 'U', 2);
    add(0.5, 'F', 4);
    add(50000000.0 * i, 'U', 4);
  }
  return bytes;
}

void expectTheTwoVertices(const std::filesystem::path& file) {
  const ScanPoints scan = readScanPoints(file);
  ASSERT_EQ(scan.points.size(), 2U);
  for (const int i : {0, 1}) {
    const LidarPoint& point = scan.points[static_cast<std::size_t>(i)];
    EXPECT_EQ(positionOf(point), Eigen::Vector3f(1.25F + static_cast<float>(i), -2.5F, 3.0F));
    EXPECT_EQ(point.intensity, 0.5F);
  }
  EXPECT_EQ(scan.rings, (std::vector<std::uint16_t>{7, 15}));
  EXPECT_EQ(scan.times_s, (std::vector<double>{0.0, 0.05}));
}

TEST(PlyCloud, AllThreeFormatsTellTheSame) {
  const TemporaryFolder folder;
  const std::string text = "1.25 -2.5 3 7 0.5 0\n2.25 -2.5 3 15 0.5 50000000\n";
  expectTheTwoVertices(folder.write("a.ply", headOf("ascii") + text));
  expectTheTwoVertices(folder.write("l.ply", headOf("binary_little_endian") + binaryVertices(false)));
  expectTheTwoVertices(folder.write("b.ply", headOf("binary_big_endian") + binaryVertices(true)));
}

TEST(PlyCloud, OtherElementsArePassedOver) {
  const TemporaryFolder folder;
  const std::string camera = "element camera 1\nproperty float focus\nproperty uchar kind\n";
  const std::string faces = "element face 1\nproperty list uchar int vertex_indices\n";
  const std::string text = "35 1\n1.25 -2.5 3 7 0.5 0\n2.25 -2.5 3 15 0.5 50000000\n3 0 1 1\n";
  expectTheTwoVertices(folder.write("a.ply", headOf("ascii", camera, faces) + text));
  expectTheTwoVertices(folder.write("b.ply", headOf("binary_little_endian", camera, faces) + "35.01" +
                                                 binaryVertices(false) + std::string(13, '\1')));
}

TEST(PlyCloud, WhatIsNoSuchFileIsRefusedWithItsPlace) {
  const TemporaryFolder folder;
  const auto expectRefused = [&](const std::string& content, const std::string& place, const std::string& reason) {
    SCOPED_TRACE(reason);
    const auto path = folder.write("cloud.ply", content);
    expectThrows<Error>([&] { readScanPoints(path); }, {path.string(), place, reason});
  };
  const std::string whole = headOf("binary_little_endian") + binaryVertices(false);
  expectRefused("", "line 1", "is no PLY file");
  expectRefused("plx\n", "line 1", "is no PLY file");
  expectRefused("ply\nformat text 1.0\n", "line 2", "'text' is none of");
  expectRefused("ply\nelement vertex -1\n", "line 2", "no whole number");
  expectRefused("ply\nelement vertex 99999999999999\n", "line 2", "no whole number");
  expectRefused("ply\nelement vertex 1\nproperty real x\n", "line 3", "type of number");
  expectRefused("ply\nproperty float x\n", "line 2", "before any element");
  expectRefused("ply\nformat ascii 1.0\nend_header\n", "line 3", "no element `vertex`");
  expectRefused("ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nend_header\n", "line 5", "no points");
  expectRefused("ply\nformat ascii 1.0\nelement vertex 1\nproperty list uchar int x\nend_header\n", "line 5", "lists");
  expectRefused("ply\nformat ascii 1.0\nelement vertex 999999999\nproperty float x\nend_header\n1\n", "offset",
                "at most");
  expectRefused("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n", "", "no field y");
  expectRefused("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\nabc\n", "line 6",
                "'abc' is no number");
  expectRefused(whole.substr(0, whole.size() - 1), "offset", "2 points are announced, where the file holds at most 1");
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const auto path = folder.write("cloud.ply", whole.substr(0, size));
    EXPECT_THROW(readScanPoints(path), Error) << size;
  }
}

TEST(PlyCloud, RealScanIsThatOfThePcdFile) {
  const std::filesystem::path data = realDataFolder();
  if (data.empty()) GTEST_SKIP() << "no real scans: set SAW_NDT_DATA to their folder";
  const auto folder = data / "sensors" / "pairs";
  const ScanPoints ply = readScanPoints(folder / "hdl32_source.ply"), pcd = readScanPoints(folder / "hdl32_source.pcd");
  ASSERT_EQ(ply.points.size(), pcd.points.size());
  for (std::size_t i = 0; i < ply.points.size(); ++i) {
    ASSERT_EQ(positionOf(ply.points[i]), positionOf(pcd.points[i])) << i;
  }
}

TEST(PlyCloud, LabelledScanKeepsItsFields) {
  const TemporaryFolder folder;
  const auto scan = folder.write("scan.ply", headOf("binary_big_endian") + binaryVertices(true));
  writeLabelledScan(folder.path() / "out.pcd", scan, {StructuralLabel::GROUND, StructuralLabel::NOISE});
  EXPECT_EQ(pointCloudFields(folder.path() / "out.pcd"),
            (std::vector<std::string>{"x", "y", "z", "ring", "intensity", "t", "label"}));
  expectTheTwoVertices(folder.path() / "out.pcd");
}

}  // namespace
}  // namespace saw_ndt
