#include "io/ros_messages.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "expect_throws.h"
#include "io/message_bytes.h"
#include "io/pcd_fields.h"
#include "real_data.h"

namespace saw_ndt::internal {
namespace {

const std::string kPoints = floatBytes({1.0F, 2.0F, 3.0F, 0.5F, -1.0F, -2.0F, -3.0F, 0.25F});

struct Form {
  MessageEncoding encoding;
  bool big_endian;

  MessageWriter writer() const { return MessageWriter(encoding, big_endian); }
};

class RosMessages : public ::testing::TestWithParam<Form> {
 protected:
  MessageEncoding encoding() const { return GetParam().encoding; }
  MessageWriter writer() const { return GetParam().writer(); }
  PcdCloud cloud(const CloudForm& form, const std::string& data) const {
    return decodePointCloud2(viewOf(cloudMessage(writer(), form, data)), encoding());
  }
};

INSTANTIATE_TEST_SUITE_P(Forms, RosMessages,
                         ::testing::Values(Form{MessageEncoding::ROS1, false}, Form{MessageEncoding::CDR, false},
                                           Form{MessageEncoding::CDR, true}));

TEST_P(RosMessages, HeadersTellStampAndFrame) {
  const std::string message = writer().addHeader(1600000000, 250000000, "/lidar").bytes();
  const MessageHeader header = decodeHeader(viewOf(message), encoding());
  EXPECT_EQ(header.stamp_s, 1600000000.25);
  EXPECT_EQ(header.frame_id, "lidar");
}

TEST_P(RosMessages, CloudsHaveTheirPointsAndFields) {
  const std::string message = cloudMessage(writer(), {}, kPoints);
  const ScanPoints scan = scanPointsOf("cloud", decodePointCloud2(viewOf(message), encoding()));
  ASSERT_EQ(scan.points.size(), 2U);
  EXPECT_EQ(scan.points[0].x, 1.0F);
  EXPECT_EQ(scan.points[0].intensity, 0.5F);
  EXPECT_EQ(scan.points[1].z, -3.0F);
  EXPECT_EQ(scan.height, 1U);
}

TEST_P(RosMessages, RowsMayHaveGapsBehindThem) {
  CloudForm form;
  form.height = 2, form.width = 1, form.row_step = 20;
  const std::string data = kPoints.substr(0, 16) + "gap!" + kPoints.substr(16);
  const ScanPoints scan = scanPointsOf("cloud", cloud(form, data));
  ASSERT_EQ(scan.points.size(), 2U);
  EXPECT_EQ(scan.points[1].x, -1.0F);
  EXPECT_EQ(scan.points[1].intensity, 0.25F);
  EXPECT_EQ(scan.height, 2U);
  EXPECT_EQ(scan.width, 1U);
}

TEST_P(RosMessages, NumbersOfBigEndianCloudsAreTurnedAround) {
  CloudForm form;
  form.big_endian = true;
  std::string data;
  for (std::size_t i = 0; i < kPoints.size(); i += 4) {
    const std::string number = kPoints.substr(i, 4);
    data += std::string(number.rbegin(), number.rend());
  }
  const ScanPoints scan = scanPointsOf("cloud", cloud(form, data));
  EXPECT_EQ(scan.points[0].y, 2.0F);
  EXPECT_EQ(scan.points[1].intensity, 0.25F);
}

TEST_P(RosMessages, CloudsLargerThanTheirDataAreRefused) {
  const auto refuse = [&](CloudForm form, const char* reason) {
    expectThrows<DamagedData>([&] { cloud(form, kPoints); }, {reason});
  };
  CloudForm form;
  form.width = 3;
  refuse(form, "the 32 bytes of the cloud are not its 1 rows of 3 points of 16 bytes");
  form = {};
  form.width = form.height = 0xFFFFFFFF;
  refuse(form, "rows of 4294967295 points");
  form = {};
  form.height = 0xFFFFFFFF, form.width = 1, form.row_step = 16;
  refuse(form, "4294967295 rows");
  form = {};
  form.height = 2, form.width = 1, form.row_step = 8;
  refuse(form, "2 rows of 1 points");
  form = {};
  form.point_step = 15;
  refuse(form, "the field intensity does not lie within a point of 15 bytes");
  form = {};
  form.point_step = 0, form.fields.clear();
  refuse(form, "points of 0 bytes");
  form = {};
  form.fields[1].second = 9;
  refuse(form, "the field y has the unknown type 9");
}

TEST_P(RosMessages, EmptyCloudsHaveNoPoints) {
  CloudForm form;
  form.width = 0, form.row_step = 0;
  EXPECT_TRUE(scanPointsOf("cloud", cloud(form, "")).points.empty());
}

TEST_P(RosMessages, PosesOfEveryTypeAreRead) {
  for (const std::string type :
       {"geometry_msgs/PoseStamped", "geometry_msgs/PoseWithCovarianceStamped", "nav_msgs/Odometry"}) {
    SCOPED_TRACE(type);
    ASSERT_TRUE(isPoseType(type));
    MessageWriter message = writer().addHeader(5, 500000000, "map");
    if (type == "nav_msgs/Odometry") message.addString("base");
    const std::string bytes = message.addTransform(1.0, -2.0, 0.5, true).bytes();
    const PoseMessage pose = decodePose(type, viewOf(bytes), encoding());
    EXPECT_EQ(pose.header.stamp_s, 5.5);
    EXPECT_EQ(pose.header.frame_id, "map");
    EXPECT_EQ(pose.child_frame_id, type == "nav_msgs/Odometry" ? "base" : "");
    EXPECT_TRUE(pose.T_frame_body.translation().isApprox(Eigen::Vector3d(1.0, -2.0, 0.5), 1e-15));
    EXPECT_TRUE((pose.T_frame_body.linear() * Eigen::Vector3d::UnitX()).isApprox(-Eigen::Vector3d::UnitX(), 1e-15));
  }
}

TEST_P(RosMessages, TransformsAreReadOneAfterTheOther) {
  MessageWriter message = writer().add(std::uint32_t{2});
  message.addHeader(5, 0, "map").addString("/base").addTransform(1.0, 2.0, 3.0);
  message.addHeader(6, 0, "base").addString("lidar").addTransform(4.0, 5.0, 6.0);
  const std::string bytes = message.bytes();
  const std::vector<TransformMessage> transforms = decodeTransforms(viewOf(bytes), encoding());
  ASSERT_EQ(transforms.size(), 2U);
  EXPECT_EQ(transforms[0].child_frame_id, "base");
  EXPECT_EQ(transforms[1].header.stamp_s, 6.0);
  EXPECT_EQ(transforms[1].T_parent_child.translation(), Eigen::Vector3d(4.0, 5.0, 6.0));
}

TEST_P(RosMessages, WhatIsNoRotationOrNotFiniteIsRefused) {
  MessageWriter zero = writer().addHeader(5, 0, "map");
  for (int i = 0; i < 7; ++i) zero.add(0.0);
  const std::string no_rotation = zero.bytes();
  expectThrows<DamagedData>([&] { decodePose("geometry_msgs/PoseStamped", viewOf(no_rotation), encoding()); },
                            {"a quaternion is no rotation"});
  const std::string not_finite = writer().addHeader(5, 0, "map").addTransform(std::nan(""), 0.0, 0.0).bytes();
  expectThrows<DamagedData>([&] { decodePose("geometry_msgs/PoseStamped", viewOf(not_finite), encoding()); },
                            {"not finite"});
}

TEST_P(RosMessages, MessagesThatAreCutAnywhereAreRefused) {
  const std::string whole = cloudMessage(writer(), {}, kPoints);
  const std::string transforms =
      writer().add(std::uint32_t{1}).addHeader(5, 0, "map").addString("base").addTransform(1.0, 2.0, 3.0).bytes();
  for (std::size_t size = 0; size + 1 < whole.size(); ++size) {
    const std::string cut(whole.data(), size);
    EXPECT_THROW(decodePointCloud2(viewOf(cut), encoding()), DamagedData) << size;
  }
  for (std::size_t size = 0; size < transforms.size(); ++size) {
    const std::string cut(transforms.data(), size);
    EXPECT_THROW(decodeTransforms(viewOf(cut), encoding()), DamagedData) << size;
  }
}

TEST_P(RosMessages, DamagedBytesNeverCrash) {
  const std::string whole = cloudMessage(writer(), {}, kPoints);
  for (std::size_t at = 0; at < whole.size(); ++at) {
    for (const char value : {'\x00', '\x7F', '\x80', '\xFF'}) {
      std::string damaged = whole;
      damaged[at] = value;
      try {
        scanPointsOf("cloud", decodePointCloud2(viewOf(damaged), encoding()));
      } catch (const std::runtime_error&) {
      }
    }
  }
}

TEST(RosMessages, OtherEncodingsAreRefused) {
  expectThrows<DamagedData>([] { decodeHeader({}, MessageEncoding::OTHER); }, {"encoding"});
}

TEST(RosMessages, ListsLongerThanTheirMessageTakeNoMemory) {
  const std::string bytes = MessageWriter(MessageEncoding::ROS1).add(std::uint32_t{0xFFFFFFFF}).add(1.0).bytes();
  expectThrows<DamagedData>([&] { decodeTransforms(viewOf(bytes), MessageEncoding::ROS1); }, {"a list is longer"});
}

TEST(RosMessages, RealCloudOfRos2IsRead) {
  const std::filesystem::path path = realDataFolder() / "sensors" / "odd_forms" / "ros2_cdr_pointcloud2.bin";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no real scans at " << path;
  std::ifstream stream(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  EXPECT_EQ(decodeHeader(viewOf(bytes), MessageEncoding::CDR).frame_id, "lidar_link");
  const ScanPoints scan = scanPointsOf(path, decodePointCloud2(viewOf(bytes), MessageEncoding::CDR));
  EXPECT_EQ(scan.points.size(), 64000U);
  EXPECT_EQ(scan.rings.size(), 64000U);
  EXPECT_EQ(scan.times_s.size(), 64000U);
  EXPECT_EQ(scan.points[0].y, 1.1178442F);
}

}  // namespace
}  // namespace saw_ndt::internal
