#include "saw_ndt/io/point_cloud_file.h"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>

#include "expect_throws.h"
#include "io/pcd_cloud.h"
#include "pcd_text.h"
#include "saw_ndt/common/error.h"
#include "temporary_folder.h"

namespace saw_ndt {
namespace {

pcl::PointCloud<pcl::PointXYZL> labelledCloud() {
  pcl::PointCloud<pcl::PointXYZL> cloud;
  for (int i = 0; i < 1000; ++i) {
    pcl::PointXYZL point;
    point.x = 0.1F * static_cast<float>(i);
    point.y = -0.3F;
    point.z = 1.0F / static_cast<float>(i + 1);
    point.label = static_cast<std::uint32_t>(i % 3);
    cloud.push_back(point);
  }
  return cloud;
}

std::string contentOf(const std::filesystem::path& path) {
  std::ostringstream content;
  content << std::ifstream(path, std::ios::binary).rdbuf();
  return content.str();
}

std::vector<double> numbersOf(const internal::PcdCloud& cloud, std::string_view name) {
  std::vector<double> numbers;
  const internal::PcdColumn* column = cloud.find({name});
  if (column != nullptr) cloud.forEach(*column, [&](std::size_t, double number) { numbers.push_back(number); });
  return numbers;
}

std::string header(const std::string& points, const std::string& data) {
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " + points +
         "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + points + "\nDATA " + data + "\n";
}

TEST(PointCloudFile, RoundTrips) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "cloud.pcd";
  const auto written = labelledCloud();
  writePcd(path, written);
  EXPECT_EQ(folder.entryCount(), 1U);
  EXPECT_EQ(pointCloudFields(path), (std::vector<std::string>{"x", "y", "z", "label"}));
  const auto read = readPointCloud<pcl::PointXYZL>(path);
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].getVector3fMap(), written[i].getVector3fMap());
    EXPECT_EQ(read[i].label, written[i].label);
  }
  EXPECT_EQ(readPointCloud<pcl::PointXYZ>(path).size(), written.size());
  EXPECT_EQ(readPointCloud<pcl::PointXYZI>(path)[5].intensity, 0.0F);
}

TEST(PointCloudFile, KeepsRowsAndColumns) {
  const TemporaryFolder folder;
  pcl::PointCloud<pcl::PointXYZI> cloud(20, 5);
  cloud(3, 4).intensity = 0.25F;
  writePcd(folder.path() / "cloud.pcd", cloud);
  const auto read = readPointCloud<pcl::PointXYZI>(folder.path() / "cloud.pcd");
  EXPECT_EQ(read.width, 20U);
  EXPECT_EQ(read.height, 5U);
  EXPECT_EQ(read(3, 4).intensity, 0.25F);
}

TEST(PointCloudFile, ReadsAscii) {
  const TemporaryFolder folder;
  const auto cloud = readPointCloud<pcl::PointXYZ>(folder.write("a.pcd", header("2", "ascii") + "1 2 3\n4 5 6"));
  ASSERT_EQ(cloud.size(), 2U);
  EXPECT_EQ(cloud[1].getVector3fMap(), Eigen::Vector3f(4, 5, 6));
}

TEST(PointCloudFile, ReadsKittiScans) {
  const TemporaryFolder folder;
  const float values[] = {1.0F, 2.0F, 3.0F, 0.5F};
  std::string bytes(sizeof(values), '\0');
  std::memcpy(bytes.data(), values, sizeof(values));
  const auto path = folder.write("000000.bin", bytes);
  EXPECT_EQ(readPointCloud<pcl::PointXYZI>(path)[0].intensity, 0.5F);
  EXPECT_EQ(readPointCloud<pcl::PointXYZ>(path)[0].z, 3.0F);
  EXPECT_EQ(pointCloudFields(path).back(), "intensity");
  expectThrows<Error>([&] { readPointCloud<pcl::PointXYZL>(path); }, {path.string(), "no labels"});
}

TEST(PointCloudFile, NamesFileAndReason) {
  const TemporaryFolder folder;
  const auto expectRefused = [&](const std::string& content, const std::string& place, const std::string& reason) {
    SCOPED_TRACE(reason);
    const auto path = folder.write("cloud.pcd", content);
    expectThrows<Error>([&] { readPointCloud<pcl::PointXYZ>(path); }, {path.string(), place, reason});
  };
  expectRefused("", "line 1", "is no PCD file");
  expectRefused("hello\n", "line 1", "is no line of a PCD header");
  expectRefused(header("2", "ascii"), "offset", "2 points are announced");
  expectRefused(header("2", "binary") + "123456789012", "offset", "at most 1");
  expectRefused(header("99999999999", "binary_compressed") + std::string(8, '\0'), "offset", "99999999999 points");
  expectRefused(header("3", "ascii") + "1.00 2.00 3.00\n4.00 5.00 6.00\n", "cloud.pcd", "is damaged");
  expectRefused(header("1", "text") + "1 2 3\n", "line 11", "DATA must be");
  expectRefused("FIELDS x y\nSIZE 4 4\nTYPE F F\nCOUNT 1 1\nWIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\n1 2\n",
                "cloud.pcd", "no field z");

  const auto plain = folder.write("plain.pcd", header("1", "ascii") + "1 2 3\n");
  expectThrows<Error>([&] { readPointCloud<pcl::PointXYZL>(plain); }, {plain.string(), "no field label"});
  expectThrows<Error>([&] { readPointCloud<pcl::PointXYZ>(folder.path() / "none.pcd"); }, {"none.pcd", "No such file"});
  expectThrows<Error>([&] { readPointCloud<pcl::PointXYZ>(folder.write("a.las", "")); }, {"a.las", ".ply or .bin"});
  expectThrows<Error>([&] { writePcd(folder.path() / "none" / "a.pcd", labelledCloud()); }, {"a.pcd", "No such file"});
  expectThrows<Error>([&] { writePcd(folder.path() / "a.pcd", pcl::PointCloud<pcl::PointXYZ>()); },
                      {"a.pcd", "without points"});
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "a.pcd"));
}

TEST(PointCloudFile, ReadsFieldsOfAnyNumberType) {
  const TemporaryFolder folder;
  const std::vector<TestField> fields = {{"label", 'U', 1, 1, {0, 2}},
                                         {"y", 'F', 8, 1, {4, 5}},
                                         {"x", 'F', 8, 1, {1, -2.5}},
                                         {"intensity", 'U', 2, 1, {40, 50}},
                                         {"z", 'I', 2, 1, {7, -8}}};
  const auto path = folder.write("a.pcd", pcdText(fields, "binary"));
  EXPECT_EQ(readPointCloud<pcl::PointXYZ>(path)[1].getVector3fMap(), Eigen::Vector3f(-2.5F, 5.0F, -8.0F));
  EXPECT_EQ(readPointCloud<pcl::PointXYZI>(path)[1].intensity, 50.0F);
  EXPECT_EQ(readPointCloud<pcl::PointXYZL>(path)[1].label, 2U);
}

TEST(PointCloudFile, LabelsThatAreNoWholeNumbersAreNamed) {
  const TemporaryFolder folder;
  for (const double label : {-1.0, 1.5, std::numeric_limits<double>::quiet_NaN()}) {
    const std::vector<TestField> fields = {
        {"x", 'F', 4, 1, {1, 2}}, {"y", 'F', 4, 1, {1, 2}}, {"z", 'F', 4, 1, {1, 2}}, {"label", 'F', 4, 1, {1, label}}};
    const auto path = folder.write("a.pcd", pcdText(fields, "ascii"));
    expectThrows<Error>([&] { readPointCloud<pcl::PointXYZL>(path); }, {"a.pcd: point 1: the label "});
    EXPECT_EQ(readPointCloud<pcl::PointXYZ>(path).size(), 2U);
  }
}

// What a scan's file tells and this library does not use is written on.
TEST(PointCloudFile, ALabelledScanKeepsTheFieldsOfItsFile) {
  const TemporaryFolder folder;
  const std::vector<double> four = {1.25, 2.5, 3.75, 5.0};
  const std::vector<TestField> fields = {{"x", 'F', 8, 1, four},
                                         {"_", 'U', 1, 3, four},
                                         {"y", 'F', 4, 1, four},
                                         {"z", 'F', 4, 1, four},
                                         {"label", 'F', 4, 1, {9, 9, 9, 9}},
                                         {"ring", 'U', 2, 1, {0, 1, 2, 3}},
                                         {"range", 'U', 4, 2, {5, 6, 7, 4e9}},
                                         {"stamp_ns", 'U', 8, 1, {1, 2, 3, 9e15}}};
  const std::vector<StructuralLabel> labels = {StructuralLabel::NOISE, StructuralLabel::GROUND,
                                               StructuralLabel::NON_GROUND, StructuralLabel::GROUND};
  for (const std::string data : {"binary", "ascii"}) {
    const auto in = folder.write("in.pcd", pcdText(fields, data, "WIDTH 2\nHEIGHT 2\n"));
    const auto out = folder.path() / "out.pcd";
    writeLabelledScan(out, in, labels);
    const std::string text = contentOf(out);
    EXPECT_EQ(text.substr(0, text.find("DATA")),
              "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z ring range stamp_ns label\n"
              "SIZE 8 4 4 2 4 8 4\nTYPE F F F U U U U\nCOUNT 1 1 1 1 2 1 1\nWIDTH 2\nHEIGHT 2\n"
              "VIEWPOINT 1 2 3 0.5 0.5 0.5 0.5\nPOINTS 4\n");
    const internal::PcdCloud before = internal::readPcdCloud(in), after = internal::readPcdCloud(out);
    for (const std::string_view name : {"x", "y", "z", "ring", "range", "stamp_ns"}) {
      EXPECT_EQ(numbersOf(after, name), numbersOf(before, name)) << name;
    }
    EXPECT_EQ(numbersOf(after, "label"), (std::vector<double>{0, 1, 2, 1}));
    expectThrows<Error>([&] { writeLabelledScan(out, in, {StructuralLabel::NOISE}); }, {"in.pcd", "1 labels", "4"});
    EXPECT_EQ(contentOf(out), text);
  }
}

TEST(PointCloudFile, RefusesEveryTruncation) {
  const TemporaryFolder folder;
  writePcd(folder.path() / "whole.pcd", labelledCloud());
  const std::string whole = contentOf(folder.path() / "whole.pcd");
  for (std::size_t size = 0; size < whole.size(); size += 97) {
    const auto path = folder.write("cut.pcd", whole.substr(0, size));
    expectThrows<Error>([&] { readPointCloud<pcl::PointXYZL>(path); }, {path.string()});
  }
}

}  // namespace
}  // namespace saw_ndt
