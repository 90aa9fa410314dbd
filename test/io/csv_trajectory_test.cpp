#include <gtest/gtest.h>

#include <string>

#include "expect_throws.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/io/trajectory.h"
#include "temporary_folder.h"

namespace saw_ndt {
namespace {

class CsvTrajectory : public ::testing::Test {
 protected:
  Trajectory read(const std::string& content) const { return readTrajectory(folder.write("t.csv", content)); }
  /// Expects one pose at 1.5 s and (1, 2, 3) that is turned by the quaternion (0, 0, 0.6, 0.8).
  void expectThePose(const std::string& content) const {
    SCOPED_TRACE(content);
    const Trajectory trajectory = read(content);
    EXPECT_EQ(trajectory.format, TrajectoryFormat::CSV);
    ASSERT_EQ(trajectory.poses.size(), 1U);
    EXPECT_NEAR(trajectory.poses[0].stamp_s, 1.5, 1e-12);
    EXPECT_EQ(trajectory.poses[0].T_map_body.translation(), Eigen::Vector3d(1, 2, 3));
    EXPECT_NEAR(heading(trajectory.poses[0].T_map_body), 2.0 * std::atan2(0.6, 0.8), 1e-12);
  }

  TemporaryFolder folder;
};

TEST_F(CsvTrajectory, WithoutNamesTheOrderIsThatOfTum) {
  expectThePose("1.5,1,2,3,0,0,0.6,0.8\n");
  expectThePose("\xEF\xBB\xBF# made by hand\r\n\r\n 1.5 , 1, 2,\t3,0,0, +0.6,8e-1\r\n");
}

TEST_F(CsvTrajectory, NamesDecideTheColumns) {
  expectThePose("stamp,x,y,z,qx,qy,qz,qw\n1.5,1,2,3,0,0,0.6,0.8\n");
  expectThePose("stamp_s,x_m,y_m,z_m,qx,qy,qz,qw\n1.5,1,2,3,0,0,0.6,0.8\n");
  expectThePose("qw,qz,qy,qx,z,y,x,time\n0.8,0.6,0,0,3,2,1,1.5\n");
  expectThePose("\"Timestamp\",\"tx\",\"ty\",\"tz\",\"qx\",\"qy\",\"qz\",\"qw\"\n\"1.5\",1,2,3,0,0,0.6,0.8\n");
  expectThePose("t,pos_x,pos_y,pos_z,quat_w,quat_x,quat_y,quat_z\n1.5,1,2,3,0.8,0,0,0.6\n");
  // Columns that are not needed may hold anything, sigmas and velocities of the same axes included.
  expectThePose(
      "frame,time [ms],position.x,position.y,position.z,orientation.x,orientation.y,orientation.z,orientation.w,vx,"
      "sigma_x_m\nmap,1500,1,2,3,0,0,0.6,0.8,,nan\n");
}

TEST_F(CsvTrajectory, EurocsGroundTruthIsRead) {
  const std::string columns =
      ", p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], v_RS_R_x [m s^-1], "
      "v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], b_w_RS_S_y [rad s^-1], b_w_RS_S_z [rad s^-1], "
      "b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], b_a_RS_S_z [m s^-2]\n";
  const std::string values = ",1,2,3,0.8,0,0,0.6,7,7,7,7,7,7,7,7,7\n";
  expectThePose("#timestamp [ns]" + columns + "1500000000" + values);
  // Without the unit, so large a number is no second.
  const Trajectory trajectory = read("#timestamp" + columns + "1403636580838555648" + values);
  EXPECT_NEAR(trajectory.poses.front().stamp_s, 1403636580.838555648, 1e-6);
}

TEST_F(CsvTrajectory, NamesFileLineAndReason) {
  const struct {
    std::string content;
    std::string place;
    std::string reason;
  } cases[] = {
      {"1,2,3\n", "line 1", "3 values, where 8 or a line of names are needed"},
      {"1,2,3,4,0,0,0,1,0,0\n", "line 1", "10 values, where 8"},
      {"1,2,3,4,0,0,0,1\n2,2\n", "line 2", "2 values, where 8"},
      {"stamp,x,y,z,qx,qy,qz,qw,more\n1,2,3,4,0,0,0,1\n", "line 2", "8 values, where 9 are named"},
      {"stamp,x,y,z,qx,qy,qz,qw\n", "t.csv", "holds no line of numbers"},
      {"stamp,x,y,qx,qy,qz\n1,2,3,0,0,0\n", "t.csv", "no column is named as z, qw"},
      {"stamp,x,tx,y,z,qx,qy,qz,qw\n1,2,2,3,4,0,0,0,1\n", "t.csv", "the columns 'x' and 'tx' may both be x"},
      {"stamp [h],x,y,z,qx,qy,qz,qw\n1,2,3,4,0,0,0,1\n", "t.csv", "stamps in 'h'"},
      {"stamp,x [mm],y,z,qx,qy,qz,qw\n1,2,3,4,0,0,0,1\n", "t.csv", "the column 'x [mm]' is not in m"},
      {"1,2,,4,0,0,0,1\n", "line 1", "0 numbers in column 3"},
      {"1,2,3 3,4,0,0,0,1\n", "line 1", "2 numbers in column 3"},
      {"1,2,x,4,0,0,0,1\n", "line 1", "'x' is no finite number"},
      {"1,2,3,4,0,0,0,1\n1,2,inf,4,0,0,0,1\n", "line 2", "'inf' is no finite number"},
      {"1,2,3,4,0,0,0,2\n", "line 1", "quaternion's norm is 2.0"},
      {",,,,,,,\n1,2,3,4,0,0,0,1\n", "t.csv", "no column is named as stamp"},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.content);
    expectThrows<Error>([&] { read(c.content); }, {"t.csv", c.place, c.reason});
  }
}

}  // namespace
}  // namespace saw_ndt
