#include <gtest/gtest.h>

#include "expect_throws.h"
#include "imported_cloud.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/drives/map_import.h"
#include "temporary_folder.h"

namespace saw_ndt {
namespace {

constexpr char kMetadata[] = "pointcloud_map_metadata.yaml";

class MapImportTiles : public ::testing::Test {
 protected:
  void SetUp() override {
    for (std::size_t i = 0; i < cloud.size(); ++i) parts[cloud[i].x < 0.0F ? 0 : 1].push_back(cloud[i]);
  }
  void writeTiles(const std::string& tile_folder) const {
    folder.write(tile_folder + "/west.pcd", pcdText(fieldsOf(parts[0]), "binary"));
    folder.write(tile_folder + "/east.pcd", pcdText(fieldsOf(parts[1]), "ascii"));
  }

  TemporaryFolder folder;
  LabelledCloud cloud = mixedCloud(5, 2000);
  LabelledCloud parts[2];
  const std::string metadata = "x_resolution: 20.0\ny_resolution: 50\neast.pcd: [0, -20]\nwest.pcd: [-20, -20.0]\n";
};

TEST_F(MapImportTiles, AutowaresTilesAreOneMap) {
  WeightedMapBuilder builder(0.5);
  addCloud(builder, cloud, Eigen::Isometry3d::Identity());
  const std::string expected = savedBytes(builder.build());

  writeTiles("flat");
  folder.write(std::string("flat/") + kMetadata, metadata);
  folder.write("flat/beside.pcd", "not read");
  const ImportedMap flat = importMap(folder.path() / "flat");
  EXPECT_EQ(flat.files, 2U);
  EXPECT_EQ(flat.files_beside, std::vector<std::string>{"beside.pcd"});
  EXPECT_TRUE(savedBytes(flat.builder.build()) == expected);

  writeTiles("map/pointcloud_map.pcd");
  folder.write(std::string("map/") + kMetadata, metadata);
  folder.write("map/pointcloud_map.pcd/beside.pcd", "not read");
  for (const char* path : {"map", "map/pointcloud_map.pcd", "map/pointcloud_map.pcd/"}) {
    const ImportedMap imported = importMap(folder.path() / path);
    EXPECT_EQ(imported.files_beside.size(), 1U) << path;
    EXPECT_TRUE(savedBytes(imported.builder.build()) == expected) << path;
  }
}

TEST_F(MapImportTiles, AMissingTileIsAnError) {
  writeTiles("map");
  const std::filesystem::path file = folder.write(std::string("map/") + kMetadata, metadata + "north.pcd: [0, 30]\n");
  expectThrows<Error>([&] { importMap(folder.path() / "map"); }, {"north.pcd", "is missing", file.string()});
}

TEST_F(MapImportTiles, DamagedMetadataAreNamedWithTheLine) {
  writeTiles("map");
  const auto fails = [&](const std::string& text, std::initializer_list<std::string> parts_of_message) {
    folder.write(std::string("map/") + kMetadata, text);
    expectThrows<Error>([&] { importMap(folder.path() / "map"); }, parts_of_message);
  };
  fails("", {kMetadata, "no map of names and values"});
  fails("- 1\n- 2\n", {kMetadata, "line 1", "no map of names and values"});
  fails("x_resolution: 20\neast.pcd: [0, 0]\n", {kMetadata, "gives no y_resolution"});
  fails("x_resolution: 20\ny_resolution: -1\n", {kMetadata, "line 2", "y_resolution must be positive"});
  fails("x_resolution: 20\ny_resolution: 20\n", {kMetadata, "names no tile"});
  fails(metadata + "a.pcd: [1]\n", {kMetadata, "line 5", "a.pcd needs the x and y"});
  fails(metadata + "a.pcd: [1, b]\n", {kMetadata, "line 5", "a.pcd has what is no number"});
  fails(metadata + "east.pcd: [0, 0]\n", {kMetadata, "line 5", "east.pcd is given twice"});
  fails(metadata + "../a.pcd: [0, 0]\n", {kMetadata, "line 5", "'../a.pcd' is no name of a PCD file"});
  fails(metadata + "a.pcd: [0, 0\n", {kMetadata, "line 6"});
  fails(std::string(100000, '['), {kMetadata, "line 1"});
}

}  // namespace
}  // namespace saw_ndt
