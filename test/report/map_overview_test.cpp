#include "report/map_overview.h"

#include <gtest/gtest.h>

#include <limits>

#include "map/map_fixtures.h"
#include "report/map_axes.h"
#include "report/map_raster.h"
#include "report/voxel_cloud.h"

namespace saw_ndt {
namespace {

TEST(MapAxes, HaveOneScaleAndShowTheWindow) {
  for (const MapWindow& asked :
       {MapWindow{-50, 50, -30, 60}, MapWindow{0, 4000, -20, 20}, MapWindow{5e6, 5e6 + 20, 0, 900}}) {
    const MapAxes axes(asked);
    const MapWindow& shown = axes.window();
    EXPECT_LE(shown.x_min, asked.x_min);
    EXPECT_GE(shown.x_max, asked.x_max);
    EXPECT_LE(shown.y_min, asked.y_min);
    EXPECT_GE(shown.y_max, asked.y_max);
    GnuplotPicture picture;
    picture.commands = "plot";
    axes.begin(picture, "a map");
    // What the axes do not take: 100 + 215 and 45 + 60.
    EXPECT_NEAR(picture.width_px - 315, (shown.x_max - shown.x_min) * axes.scale_px(), 1.0);
    EXPECT_NEAR(picture.height_px - 105, (shown.y_max - shown.y_min) * axes.scale_px(), 1.0);
    EXPECT_GE(picture.height_px, 434);
    EXPECT_LE(picture.width_px, 1235);
    EXPECT_NE(picture.commands.find("set size ratio -1\n"), std::string::npos);
    EXPECT_EQ(picture.commands.substr(picture.commands.size() - 4), "plot");
  }
}

TEST(MapRaster, ShowsTheTopmostVoxelOfEveryCell) {
  // Three metres of a map in voxels of 1 m: a voxel a cell.
  MapRaster fine(MapAxes({-1.0, 2.0, 0.0, 3.0}), 1.0);
  EXPECT_EQ(fine.cell_m(), 1.0);
  fine.set({-1, 0, 5}, 5.5, 7.0);
  fine.set({-1, 0, 2}, 2.5, 8.0);
  fine.set({1, 2, 2}, 2.5, 9.0);
  fine.set({1, 2, 3}, 3.5, 6.0);
  fine.set({9, 9, 9}, 9.5, 1.0);  // outside
  EXPECT_EQ(fine.data("$a"), "$a << END_OF_DATA\n7 NaN NaN \nNaN NaN NaN \nNaN NaN 6 \nEND_OF_DATA\n");
  EXPECT_EQ(fine.plot("$a"), "$a matrix using (-0.5 + 1 * $1):(0.5 + 1 * $2):3 with image notitle");
}

TEST(MapRaster, HasCellsOfSeveralVoxelsInLargeMaps) {
  // 1,000 km, 920 picture elements of the axes and 1.5 in the file for each: 725 m.
  const MapAxes axes({-500000.0, 500000.0, -1000.0, 1000.0});
  MapRaster raster(axes, 0.5);
  EXPECT_NEAR(raster.cell_m(), 725.0, 1.0);
  EXPECT_EQ(std::remainder(raster.cell_m(), 0.5), 0.0);
  raster.set({-1, -1, 0}, 1.0, 3.0);
  raster.set({-2, -2, 0}, 2.0, 4.0);
  raster.set({0, 0, 0}, 0.0, 5.0);
  const std::string data = raster.data("$a");
  EXPECT_EQ(data.find('3'), std::string::npos);
  EXPECT_NE(data.find(" 4 "), std::string::npos);
  EXPECT_NE(data.find(" 5 "), std::string::npos);
  EXPECT_LT(data.size(), 4U * 1400U * 600U);
}

TEST(MapRaster, HoldsVoxelsAsFarApartAsCanBe) {
  const int far = std::numeric_limits<int>::max();
  const std::vector<VoxelCoordinate> voxels = {{-far, -far, 0}, {far, far, 0}};
  MapRaster raster(MapAxes(windowAround(voxels, 0.5)), 0.5);
  raster.set(voxels[0], 0.0, 1.0);
  raster.set(voxels[1], 0.0, 2.0);
  const std::string data = raster.data("$a");
  EXPECT_NE(data.find(" 1 "), std::string::npos);
  EXPECT_NE(data.find(" 2 "), std::string::npos);
}

TEST(MapOverview, HasEveryVoxelWithItsLabelClassAndWeight) {
  const WeightedVoxelMap map = mapOf(mixedCloud(3, 6000));
  const std::vector<OverviewVoxel> voxels = overviewVoxels(map);
  const std::vector<VoxelStatistics> expected = map.statistics();
  ASSERT_EQ(voxels.size(), expected.size());
  const pcl::PointCloud<VoxelPoint> cloud = voxelCloud(map);
  std::size_t ground = 0;
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    EXPECT_EQ(voxels[i].voxel, expected[i].voxel);
    EXPECT_EQ(voxels[i].weight, expected[i].weight);
    EXPECT_EQ(voxels[i].structure_class, expected[i].structure_class);
    EXPECT_EQ(voxels[i].height_m, expected[i].mean(1.0).z());
    EXPECT_EQ(static_cast<std::uint32_t>(voxels[i].label), cloud[i].label);
    ground += static_cast<std::size_t>(voxels[i].label == StructuralLabel::GROUND);
  }
  EXPECT_GT(ground, 10U);
  EXPECT_LT(ground, voxels.size());
}

TEST(MapOverview, OfAnEmptyMapIsAPicture) {
  for (const OverviewColour colour : {OverviewColour::LABEL, OverviewColour::HEIGHT}) {
    const GnuplotPicture picture = overviewPicture({}, 0.5, colour, "nothing");
    EXPECT_NE(picture.commands.find("plot $voxels matrix"), std::string::npos);
    EXPECT_GT(picture.width_px, 300);
  }
}

}  // namespace
}  // namespace saw_ndt
