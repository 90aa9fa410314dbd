#include <gtest/gtest.h>

#include "expect_throws.h"
#include "io/kitti_oxts.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/io/kitti.h"
#include "temporary_folder.h"

namespace saw_ndt {
namespace {

class KittiCalibrationForms : public ::testing::Test {
 protected:
  Eigen::Isometry3d read(const std::string& text) const {
    return readKittiCalibration(folder.write("calib.txt", text));
  }

  TemporaryFolder folder;
};

const Eigen::Vector3d kPlace(0.1, 0.2, 0.3);

TEST_F(KittiCalibrationForms, KeysMayHaveAColonOrNot) {
  for (const std::string key : {"Tr:", "Tr :", "Tr", "Tr\t:\t", "  Tr:", "Tr_velo_to_cam:", "Tr_velo_cam",
                                "Tr_velo_to_cam :", "\xEF\xBB\xBFTr:"}) {
    for (const std::string end : {"\n", "\r\n", ""}) {
      const Eigen::Isometry3d T = read(key + " 0 -1 0 0.1 0 0 -1\t0.2 1 0 0 0.3" + end);
      EXPECT_EQ(T.translation(), kPlace) << key;
      EXPECT_LT((T.linear() * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitZ()).norm(), 1e-12) << key;
    }
  }
}

// As in KITTI's files of objects and of tracking: P = P2 R0 Tr.
TEST_F(KittiCalibrationForms, ARectificationIsMultipliedIn) {
  const std::string Tr = "Tr_velo_to_cam: 0 -1 0 0.1 0 0 -1 0.2 1 0 0 0.3\n";
  // A quarter turn about the camera's z axis.
  const std::string R = " 0 -1 0 1 0 0 0 0 1\n";
  for (const std::string& text : {"R0_rect:" + R + Tr, Tr + "R_rect" + R, "R_rect :" + R + Tr}) {
    const Eigen::Isometry3d T = read(text);
    EXPECT_LT((T.translation() - Eigen::Vector3d(-0.2, 0.1, 0.3)).norm(), 1e-12) << text;
    EXPECT_LT((T.linear() * Eigen::Vector3d::UnitY() - Eigen::Vector3d(0, -1, 0)).norm(), 1e-12) << text;
  }
  // The line Tr of the odometry benchmark is of the rectified camera.
  EXPECT_EQ(read("R0_rect:" + R + Tr + "Tr: 0 -1 0 0.1 0 0 -1 0.2 1 0 0 0.3\n").translation(), kPlace);
}

TEST_F(KittiCalibrationForms, WhatIsWrongIsNamedWithItsLine) {
  const std::string Tr = "Tr_velo_to_cam: 0 -1 0 0.1 0 0 -1 0.2 1 0 0 0.3\n";
  const std::pair<std::string, const char*> cases[] = {
      {"P0: 1\nTr 1 2 3\n", "calib.txt: line 2: 3 numbers, where 12"},
      {Tr + "R0_rect: 1 0 0\n", "calib.txt: line 2: 3 numbers, where 9"},
      {Tr + "R0_rect: 1 0 0 0 2 0 0 0 1\n", "calib.txt: line 2: is no rigid transform"},
      {"Tr :: 0 -1 0 0.1 0 0 -1 0.2 1 0 0 0.3\n", "calib.txt: line 1: ':' is no finite number"},
      {"Track: 0 -1 0 0.1 0 0 -1 0.2 1 0 0 0.3\n", "calib.txt: no line Tr"}};
  for (const auto& [text, reason] : cases) {
    expectThrows<Error>([&, content = text] { read(content); }, {reason});
  }
}

TEST_F(KittiCalibrationForms, RawTransformsNeedALineOfARotationAndOneOfATranslation) {
  const std::string R = "R: 0 -1 0 0 0 -1 1 0 0\n";
  const auto readRaw = [&](const std::string& text) {
    return internal::readKittiRawTransform(folder.write("calib_velo_to_cam.txt", text));
  };
  for (const std::string T : {"T: 0.1 0.2 0.3\n", "T 0.1 0.2 0.3", "T : 0.1 0.2 0.3\r\n"}) {
    EXPECT_EQ(readRaw("calib_time: 15-Mar-2012 11:37:16\n" + R + T).translation(), kPlace) << T;
  }
  for (const std::string T : {"", "T", "T\n", "T:", "T:\n", "T: 1 2\n", "T: 1 2 3 4\n"}) {
    expectThrows<Error>([&] { readRaw(R + T); }, {"calib_velo_to_cam.txt", "a line T of 3"});
    expectThrows<Error>([&] { readRaw(T + "\nR\nT: 1 2 3\n"); }, {"calib_velo_to_cam.txt", "a line R of 9"});
  }
}

}  // namespace
}  // namespace saw_ndt
