#include "drives/bag_recording.h"

#include <gtest/gtest.h>

#include "expect_throws.h"
#include "io/ros1_bag_bytes.h"
#include "saw_ndt/common/error.h"
#include "temporary_folder.h"

namespace saw_ndt::internal {
namespace {

const std::string kPoints = floatBytes({1.0F, 2.0F, 3.0F, 0.5F, -1.0F, -2.0F, -3.0F, 0.25F});
constexpr std::uint32_t kStart_s = 100;

MessageWriter writer() { return MessageWriter(MessageEncoding::ROS1); }

/// A drive along x at 2 m/s whose clouds are 0.1 s apart and recorded 0.05 s late.
class BagRecordingTest : public ::testing::Test {
 protected:
  enum Topic : std::uint32_t { POINTS, MORE_POINTS, ODOMETRY, POSE, TF, TF_STATIC };

  static std::uint32_t nanoseconds(int scan) { return 100000000U * static_cast<std::uint32_t>(scan); }

  void addCloud(Topic topic, int scan, std::uint32_t stamp_s = kStart_s) {
    const std::uint32_t stamp_ns = stamp_s == 0 ? 0 : nanoseconds(scan);
    messages_.push_back(
        {topic, kStart_s, nanoseconds(scan) + 50000000, cloudMessage(writer(), {}, kPoints, stamp_s, stamp_ns)});
  }
  /// At 0.5 s and 0.7 s, say; a pose is where the body is at this moment.
  void addPose(Topic topic, int tenth_s, const std::string& child = "") {
    MessageWriter message = writer();
    if (topic == TF) message.add(std::uint32_t{1});
    message.addHeader(kStart_s, nanoseconds(tenth_s), topic == TF ? "/odom" : "odom");
    if (topic != POSE) message.addString(child);
    const std::string data = message.addTransform(0.2 * tenth_s, 0.0, 0.0).bytes();
    messages_.push_back({topic, kStart_s, nanoseconds(tenth_s), data});
  }
  void addMounting(const std::string& parent, double z) {
    const std::string data =
        writer().add(std::uint32_t{1}).addHeader(0, 0, parent).addString("lidar").addTransform(0.0, 0.0, z).bytes();
    messages_.push_back({TF_STATIC, kStart_s, 0, data});
  }
  std::filesystem::path file() const {
    Ros1BagWriter bag({{"/points", "sensor_msgs/PointCloud2"},
                       {"/more", "sensor_msgs/PointCloud2"},
                       {"/odometry", "nav_msgs/Odometry"},
                       {"/pose", "geometry_msgs/PoseStamped"},
                       {"/tf", "tf2_msgs/TFMessage"},
                       {"/tf_static", "tf2_msgs/TFMessage"}});
    return folder_.write("drive.bag", bag.addChunk(messages_).bytes());
  }
  std::unique_ptr<Recording> open(const RecordingOptions& options = {}) const { return openBag(file(), options); }
  static RecordingOptions byPoses(const std::string& topic, const std::string& fixed_frame = "") {
    RecordingOptions options;
    options.pose_topic = topic;
    options.fixed_frame = fixed_frame;
    return options;
  }
  static void expectAt(const Recording& recording, int scan, double x, double z) {
    const std::optional<Eigen::Isometry3d> pose = recording.referencePose(scan);
    ASSERT_TRUE(pose.has_value());
    EXPECT_LT((pose->translation() - Eigen::Vector3d(x, 0.0, z)).norm(), 1e-6);
  }

  TemporaryFolder folder_;
  std::vector<Ros1BagWriter::Message> messages_;
};

TEST_F(BagRecordingTest, ScansAreTheMessagesOfTheOnlyTopicOfClouds) {
  for (int scan = 0; scan < 3; ++scan) addCloud(POINTS, scan);
  const auto recording = open();
  EXPECT_EQ(recording->name(), "drive");
  ASSERT_EQ(recording->scanCount(), 3);
  EXPECT_EQ(recording->scanName(2), "/points message 2");
  EXPECT_TRUE(recording->hasStamps());
  EXPECT_EQ(recording->stamps(), (std::vector<double>{100.0, 100.1, 100.2}));
  ScanPoints scan;
  recording->readScan(1, scan);
  ASSERT_EQ(scan.points.size(), 2U);
  EXPECT_EQ(scan.points[1].z, -3.0F);
  EXPECT_FALSE(recording->hasPoses());
  EXPECT_THROW(recording->readScan(3, scan), std::out_of_range);
}

TEST_F(BagRecordingTest, HeadersWithoutStampHaveTheTimeOfRecording) {
  addCloud(POINTS, 0, 0);
  EXPECT_EQ(open()->stamps(), std::vector<double>{100.05});
}

TEST_F(BagRecordingTest, SeveralTopicsOfCloudsAreListedUnlessOneIsChosen) {
  addCloud(POINTS, 0);
  addCloud(MORE_POINTS, 1);
  expectThrows<Error>([&] { open(); },
                      {"-topic", "/points (sensor_msgs/PointCloud2, 1 message), /more (sensor_msgs/PointCloud2"});
  RecordingOptions options;
  options.topic = "/more";
  EXPECT_EQ(open(options)->stamps(), std::vector<double>{100.1});
  options.topic = "/odometry";
  expectThrows<Error>([&] { open(options); }, {"/odometry", "its topics: /points", "/tf (tf2_msgs/TFMessage, 0"});
}

TEST_F(BagRecordingTest, ADamagedMessageHasTheTimeOfRecordingAndTheOthersAreRead) {
  for (int scan = 0; scan < 3; ++scan) addCloud(POINTS, scan);
  messages_[1].data.resize(10);
  const auto recording = open();
  EXPECT_EQ(recording->stamps(), (std::vector<double>{100.0, 100.15, 100.2}));
  ScanPoints scan;
  expectThrows<Error>([&] { recording->readScan(1, scan); }, {"drive.bag: /points message 1"});
  recording->readScan(2, scan);
  EXPECT_EQ(scan.points.size(), 2U);
}

TEST_F(BagRecordingTest, PosesOfTheLidarAreInterpolated) {
  for (int scan = 0; scan < 9; ++scan) addCloud(POINTS, scan);
  for (const int tenth_s : {1, 4, 6}) addPose(POSE, tenth_s);
  const auto recording = open();
  ASSERT_TRUE(recording->hasPoses());
  EXPECT_FALSE(recording->referencePose(0).has_value());
  expectAt(*recording, 1, 0.2, 0.0);
  expectAt(*recording, 2, 0.4, 0.0);
  expectAt(*recording, 5, 1.0, 0.0);
  EXPECT_FALSE(recording->referencePose(7).has_value());
  EXPECT_FALSE(open(byPoses("none"))->hasPoses());
}

TEST_F(BagRecordingTest, PosesOfABodyAreBroughtToTheLidarByTransforms) {
  for (int scan = 0; scan < 3; ++scan) addCloud(POINTS, scan);
  for (const int tenth_s : {0, 2}) addPose(ODOMETRY, tenth_s, "base");
  expectAt(*open(), 1, 0.2, 0.0);
  addMounting("/base", 1.5);
  expectAt(*open(), 1, 0.2, 1.5);
}

TEST_F(BagRecordingTest, DamagedPosesArePassedOver) {
  for (int scan = 0; scan < 3; ++scan) addCloud(POINTS, scan);
  for (const int tenth_s : {0, 1, 2}) addPose(POSE, tenth_s);
  messages_[4].data.resize(30);
  expectAt(*open(), 1, 0.2, 0.0);
  for (const int message : {3, 5}) messages_[static_cast<std::size_t>(message)].data.clear();
  EXPECT_FALSE(open()->hasPoses());
}

TEST_F(BagRecordingTest, SeveralTopicsOfPosesAreListedUnlessOneIsChosen) {
  addCloud(POINTS, 1);
  for (const int tenth_s : {0, 2}) addPose(POSE, tenth_s);
  for (const int tenth_s : {1, 3}) addPose(ODOMETRY, tenth_s, "base");
  expectThrows<Error>([&] { open(); }, {"-pose-topic", "/odometry (nav_msgs/Odometry, 2 messages), /pose"});
  expectAt(*open(byPoses("/pose")), 0, 0.2, 0.0);
  expectThrows<Error>([&] { open(byPoses("/points")); }, {"no poses on /points", "its topics"});
  RecordingOptions options;
  options.poses_file = "poses.txt";
  EXPECT_FALSE(open(options)->hasPoses());
}

TEST_F(BagRecordingTest, TransformsArePosesWhereTheLidarMovesInThem) {
  for (int scan = 0; scan < 3; ++scan) addCloud(POINTS, scan);
  addMounting("base", 1.5);
  EXPECT_FALSE(open()->hasPoses());
  expectThrows<Error>([&] { open(byPoses("tf", "odom"))->hasPoses(); },
                      {"no chain from odom to the frame of the clouds, 'lidar'", "base, lidar"});
  for (const int tenth_s : {0, 2}) addPose(TF, tenth_s, "base");
  const auto recording = open();
  ASSERT_TRUE(recording->hasPoses());
  expectAt(*recording, 1, 0.2, 1.5);
  expectAt(*open(byPoses("tf", "/base")), 1, 0.0, 1.5);
}

TEST_F(BagRecordingTest, TransformsThatAreMissingAreAnError) {
  addCloud(POINTS, 0);
  expectThrows<Error>([&] { open(byPoses("tf")); }, {"has no topic of transforms"});
}

}  // namespace
}  // namespace saw_ndt::internal
