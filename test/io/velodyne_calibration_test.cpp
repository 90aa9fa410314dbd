#include "io/velodyne_calibration.h"

#include <gtest/gtest.h>

#include "expect_throws.h"
#include "io/velodyne_calibration_text.h"
#include "io/velodyne_lasers.h"
#include "io/velodyne_sensor.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"
#include "temporary_folder.h"

namespace saw_ndt::internal {
namespace {

class VelodyneCalibration : public ::testing::Test {
 protected:
  void expectRefused(const std::string& text, std::initializer_list<std::string> parts) {
    const auto file = folder.write("db.xml", text);
    expectThrows<Error>([&] { readVelodyneCalibration(file); }, parts);
  }

  TemporaryFolder folder;
};

TEST_F(VelodyneCalibration, IsReadInMetresAndDegrees) {
  const auto corrections = readVelodyneCalibration(folder.write("db.xml", calibrationText(64)));
  EXPECT_DOUBLE_EQ(corrections[3].azimuth_deg, -3.0);
  EXPECT_NEAR(corrections[3].elevation_deg, 0.8, 1e-12);
  EXPECT_DOUBLE_EQ(corrections[3].distance_m, 1.2);
  EXPECT_DOUBLE_EQ(corrections[3].vertical_offset_m, 0.21);
  EXPECT_DOUBLE_EQ(corrections[3].horizontal_offset_m, 0.026);
}

TEST_F(VelodyneCalibration, PlacesTheReturnsOfAnHdl64e) {
  const VelodyneLasers lasers(VelodyneModel::HDL_64E, folder.write("db.xml", calibrationText(64)));
  VelodynePacket packet = VelodynePacket::ofHdl64e();
  for (std::size_t block = 0; block < 12; ++block) packet.setAzimuth(block, 9000);
  packet.setReturn(1, 1, 5000, 200);  // laser 33
  std::vector<VelodyneFiring> firings;
  readVelodyneFirings(packet.data(), VelodyneModel::HDL_64E, firings);
  ScanPoints scan;
  lasers.addReturns(packet.data(), firings[0], 100.0, scan);
  ASSERT_EQ(scan.points.size(), 1U);
  // Clockwise by 90 + 3 degrees; beside the line of sight by 26 mm, to the left where it looks forward.
  const double azimuth = radiansFromDegrees(93.0), elevation = radiansFromDegrees(2.0 - 0.4 * 33);
  const double level = 11.2 * std::cos(elevation);
  EXPECT_NEAR(scan.points[0].x, level * std::cos(azimuth) + 0.026 * std::sin(azimuth), 1e-5);
  EXPECT_NEAR(scan.points[0].y, -level * std::sin(azimuth) + 0.026 * std::cos(azimuth), 1e-5);
  EXPECT_NEAR(scan.points[0].z, 11.2 * std::sin(elevation) + 0.21, 1e-5);
  EXPECT_EQ(scan.rings[0], 63 - 33);
  EXPECT_NEAR(scan.times_s[0], 100.0 + 1.26e-6, 1e-9);
}

TEST_F(VelodyneCalibration, IsNeededForAnHdl64e) {
  expectThrows<Error>([] { VelodyneLasers(VelodyneModel::HDL_64E, {}); }, {"HDL-64E", "calibration"});
}

TEST_F(VelodyneCalibration, DamagedOnesAreRefused) {
  expectThrows<Error>([&] { readVelodyneCalibration(folder.path() / "none.xml"); }, {"none.xml"});
  expectRefused("", {"db.xml", "boost_serialization.DB.points_"});
  expectRefused("<a><b></a>", {"db.xml", "line 1"});
  expectRefused("<a/>", {"points_", "no calibration"});
  expectRefused(calibrationText(63), {"laser 63 is missing"});
  expectRefused(calibrationText(64, laserText(5)), {"laser 5", "twice"});
  expectRefused(calibrationText(64, laserText(64)), {"laser 64", "0 to 63"});
  expectRefused(calibrationText(64, laserText(-1)), {"laser -1", "0 to 63"});
  expectRefused(calibrationText(63, "<item><px><id_>63</id_></px></item>"), {"laser 63", "rotCorrection_"});
  expectRefused("<boost_serialization><DB><distLSB_>0.4</distLSB_><points_/></DB></boost_serialization>", {"distLSB_"});
}

TEST_F(VelodyneCalibration, HostileOnesAreRefused) {
  std::string deep;
  for (int i = 0; i < 200000; ++i) deep += "<a>";
  expectRefused(deep, {"within too many"});
  expectRefused(std::string((std::size_t{1} << 20) + 1, ' '), {"longer"});
}

}  // namespace
}  // namespace saw_ndt::internal
