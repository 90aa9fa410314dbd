#include "saw_ndt/drives/map_import.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "expect_throws.h"
#include "imported_cloud.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/io/point_cloud_file.h"
#include "temporary_folder.h"

namespace saw_ndt {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

class MapImport : public ::testing::Test {
 protected:
  std::string importedBytes(const std::filesystem::path& file, const MapImportOptions& options = {}) const {
    return savedBytes(importMap(file, options).builder.build());
  }

  /// The map of one scan of these points.
  static std::string scanBytes(const LabelledCloud& scan, bool labels = true) {
    WeightedMapBuilder builder(0.5);
    if (labels) {
      addCloud(builder, scan, Eigen::Isometry3d::Identity());
    } else {
      addCloud(builder, withoutLabels(scan), Eigen::Isometry3d::Identity());
    }
    return savedBytes(builder.build());
  }

  TemporaryFolder folder;
  LabelledCloud cloud = mixedCloud(3, 3001);
};

TEST_F(MapImport, EveryKindOfFileGivesTheMapOfOneScanOfItsPoints) {
  const std::string expected = scanBytes(cloud);
  const std::vector<TestField> fields = fieldsOf(cloud);
  writePcd(folder.path() / "compressed.pcd", cloud);
  EXPECT_TRUE(importedBytes(folder.write("ascii.pcd", pcdText(fields, "ascii"))) == expected);
  EXPECT_TRUE(importedBytes(folder.write("binary.pcd", pcdText(fields, "binary"))) == expected);
  EXPECT_TRUE(importedBytes(folder.path() / "compressed.pcd") == expected);
  EXPECT_TRUE(importedBytes(folder.write("ascii.ply", plyText(cloud, false))) == expected);
  EXPECT_TRUE(importedBytes(folder.write("binary.ply", plyText(cloud, true))) == expected);
}

TEST_F(MapImport, BlocksAndThreadsDoNotChangeABit) {
  writePcd(folder.path() / "compressed.pcd", cloud);
  const std::filesystem::path files[] = {folder.path() / "compressed.pcd",
                                         folder.write("ascii.pcd", pcdText(fieldsOf(cloud), "ascii")),
                                         folder.write("binary.ply", plyText(cloud, true))};
  for (const ImportedLabels labels : {ImportedLabels::AUTO, ImportedLabels::NONE, ImportedLabels::HEIGHTS}) {
    MapImportOptions options;
    options.labels = labels;
    const std::string expected = importedBytes(files[0], options);
    for (const auto& file : files) {
      for (const std::size_t block_points : {1U, 7U, 1000U, 3001U}) {
        options.block_points = block_points;
        options.threads = block_points == 7U ? 1 : 2;
        EXPECT_TRUE(importedBytes(file, options) == expected) << file << ' ' << block_points;
      }
    }
  }
}

TEST_F(MapImport, WithoutTheLabelsOfThisProjectTheMapIsUnlabelledAndSaysWhy) {
  const std::string expected = scanBytes(cloud, false);
  std::vector<TestField> fields = fieldsOf(cloud, false);
  const ImportedMap none = importMap(folder.write("none.pcd", pcdText(fields, "binary")));
  EXPECT_NE(none.why_unlabelled.find("none.pcd has no field label"), std::string::npos) << none.why_unlabelled;
  EXPECT_TRUE(savedBytes(none.builder.build()) == expected);
  fields = fieldsOf(cloud);
  fields[3].values.back() = 40.0;  // found when all but the last block have been added
  MapImportOptions options;
  options.block_points = 100;
  const ImportedMap foreign = importMap(folder.write("foreign.pcd", pcdText(fields, "binary")), options);
  EXPECT_NE(foreign.why_unlabelled.find("labels other than"), std::string::npos) << foreign.why_unlabelled;
  EXPECT_EQ(foreign.points_read, cloud.size());
  EXPECT_TRUE(savedBytes(foreign.builder.build()) == expected);
  fields[3].values.assign(cloud.size(), 0.0);
  const ImportedMap zeros = importMap(folder.write("zeros.pcd", pcdText(fields, "binary")));
  EXPECT_EQ(zeros.why_unlabelled, "all labels are 0 (noise)");
  EXPECT_TRUE(savedBytes(zeros.builder.build()) == expected);
}

TEST_F(MapImport, CoordinatesOfUtmKeepAMillimetre) {
  std::vector<TestField> fields = {{"x", 'F', 8, 1, {}}, {"y", 'F', 8, 1, {}}, {"z", 'F', 8, 1, {}}};
  // Voxels of 6 points or more, each within its voxel; the mean is that of the points.
  for (int i = 0; i < 64; ++i) {
    fields[0].values.push_back(456789.123 + 0.001 * (i % 4));
    fields[1].values.push_back(5432109.876 + 0.001 * (i / 4 % 4));
    fields[2].values.push_back(123.321 + 0.001 * (i / 16));
  }
  const ImportedMap imported = importMap(folder.write("utm.pcd", pcdText(fields, "binary")));
  EXPECT_EQ(imported.origin_m, (std::array<double, 3>{457000.0, 5432000.0, 0.0}));
  const std::vector<VoxelStatistics> voxels = imported.builder.build().statistics();
  ASSERT_EQ(voxels.size(), 1U);
  const Eigen::Vector3d expected(456789.1245 - 457000.0, 5432109.8775 - 5432000.0, 123.3225);
  EXPECT_LT((voxels[0].mean(0.5) - expected).cwiseAbs().maxCoeff(), 2e-5) << voxels[0].mean(0.5).transpose();

  MapImportOptions options;
  options.origin_m = {456000.0, 5432000.0, 100.0};
  const ImportedMap stated = importMap(folder.path() / "utm.pcd", options);
  EXPECT_EQ(stated.origin_m, *options.origin_m);
  EXPECT_EQ(stated.builder.build().origin().map_origin_m, Eigen::Vector3d(456000.0, 5432000.0, 100.0));
  const Eigen::Vector3d moved = expected + Eigen::Vector3d(1000.0, 0.0, -100.0);
  EXPECT_TRUE(stated.builder.build().find(moved).has_value());
}

TEST_F(MapImport, PointsThatAreNoneArePassedOverAndCounted) {
  std::vector<TestField> fields = fieldsOf(cloud, false);
  const std::string expected = importedBytes(folder.write("whole.pcd", pcdText(fields, "binary")));
  const double others[][3] = {{kNaN, 1.0, 2.0}, {0.0, 0.0, 0.0}, {1.0, 2.0, HUGE_VAL}, {3e30, 1.0, 1.0}};
  for (const auto& other : others) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      fields[axis].values.insert(fields[axis].values.begin() + 1000, other[axis]);
    }
  }
  const ImportedMap imported = importMap(folder.write("others.pcd", pcdText(fields, "binary")));
  EXPECT_EQ(imported.points_read, cloud.size() + 4);
  EXPECT_EQ(imported.points_not_finite, 2U);
  EXPECT_EQ(imported.points_at_zero, 1U);
  EXPECT_EQ(imported.builder.origin().point_count, cloud.size());
  EXPECT_TRUE(savedBytes(imported.builder.build()) == expected);
  for (std::size_t axis = 0; axis < 3; ++axis) fields[axis].values.assign(5, kNaN);
  const std::filesystem::path empty = folder.write("empty.pcd", pcdText(fields, "binary"));
  expectThrows<Error>([&] { importMap(empty); }, {"empty.pcd", "holds no point for a map", "5"});
}

TEST_F(MapImport, AFolderIsTheMapOfAllItsFiles) {
  LabelledCloud parts[3];
  for (std::size_t i = 0; i < cloud.size(); ++i) parts[i % 3].push_back(cloud[i]);
  folder.write("map/10.pcd", pcdText(fieldsOf(parts[0]), "ascii"));
  folder.write("map/9.ply", plyText(parts[1], true));
  writePcd(folder.path() / "map" / "1.pcd", parts[2]);
  folder.write("map/read.me", "");
  const ImportedMap imported = importMap(folder.path() / "map");
  EXPECT_EQ(imported.files, 3U);
  EXPECT_TRUE(savedBytes(imported.builder.build()) == scanBytes(cloud));
}

TEST_F(MapImport, DamagedFilesAreNamedWithThePlace) {
  MapImportOptions options;
  options.block_points = 100;
  const std::vector<TestField> fields = fieldsOf(cloud);
  const auto fails = [&](const std::filesystem::path& file, std::initializer_list<std::string> parts) {
    expectThrows<Error>([&] { importMap(file, options); }, parts);
  };
  const std::string binary = pcdText(fields, "binary");
  fails(folder.write("short.pcd", binary.substr(0, binary.size() - 1)), {"short.pcd", "offset", "3001 points"});
  std::string ascii = pcdText(fields, "ascii");
  fails(folder.write("more.pcd", ascii + "1 2 3 1\n"), {"more.pcd", "line 3013", "more points than the 3001"});
  const std::size_t last_line = ascii.rfind('\n', ascii.size() - 2) + 1;
  ascii.insert(last_line, "x");
  fails(folder.write("word.pcd", ascii), {"word.pcd", "line 3012", "is no number of the field x"});
  fails(folder.path() / "missing.pcd", {"missing.pcd", "No such file"});
  fails(folder.write("a.bin", "0123456789abcdef"), {"a.bin", "must end in .pcd or .ply"});
  fails(folder.write("no_z.pcd", pcdText({fields[0], fields[1]}, "binary")), {"no_z.pcd", "has no field z"});
  std::filesystem::create_directory(folder.path() / "empty");
  fails(folder.path() / "empty", {"empty", "holds no .pcd or .ply file"});
}

TEST_F(MapImport, OptionsThatDoNotHoldAreNamed) {
  MapImportOptions options;
  options.block_points = 0;
  expectThrows<std::invalid_argument>([&] { options.check(); }, {"block_points = 0"});
  options = MapImportOptions();
  options.origin_m = {0.0, kNaN, 0.0};
  expectThrows<std::invalid_argument>([&] { options.check(); }, {"origin_m = nan"});
  options = MapImportOptions();
  options.resolution_m = 0.0;
  expectThrows<std::invalid_argument>([&] { options.check(); }, {"resolution_m = 0"});
}

}  // namespace
}  // namespace saw_ndt
