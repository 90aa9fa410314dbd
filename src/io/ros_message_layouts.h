#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "io/ros_messages.h"
#include "io/stamp_seconds.h"

namespace saw_ndt::internal {

// The members of each message, in order, once for every Decoder: a class with
//   Number read<Number>()              the next number
//   std::string readString()           the next string
//   std::size_t readCount(bytes)       the number of elements of a list, each of which takes `bytes` at least
//   ByteView readBytes()               a list of bytes, the last member that is read
//   kIsRos1                            whether headers are those of ROS 1
// each of which throws DamagedData where the message ends before.

inline constexpr char kPoseStamped[] = "geometry_msgs/PoseStamped";
inline constexpr char kPoseWithCovarianceStamped[] = "geometry_msgs/PoseWithCovarianceStamped";
inline constexpr char kOdometry[] = "nav_msgs/Odometry";

template <typename Decoder>
std::string readFrame(Decoder& decoder) {
  const std::string name = decoder.readString();
  return name.substr(std::min(name.find_first_not_of('/'), name.size()));
}

template <typename Decoder>
MessageHeader readHeader(Decoder& decoder) {
  MessageHeader header;
  if constexpr (Decoder::kIsRos1) decoder.template read<std::uint32_t>();  // its number
  const auto seconds = decoder.template read<std::uint32_t>();
  const auto nanoseconds = decoder.template read<std::uint32_t>();
  header.stamp_s = stampSeconds(
      Decoder::kIsRos1 ? std::int64_t{seconds} : std::int64_t{static_cast<std::int32_t>(seconds)}, nanoseconds);
  header.frame_id = readFrame(decoder);
  return header;
}

/// A position and a quaternion.
template <typename Decoder>
Eigen::Isometry3d readTransform(Decoder& decoder) {
  constexpr double kGreatestDeviation = 0.01;
  double values[7];
  for (double& value : values) {
    value = decoder.template read<double>();
    if (!std::isfinite(value)) throw DamagedData("a pose has a number that is not finite");
  }
  const Eigen::Quaterniond rotation(values[6], values[3], values[4], values[5]);
  if (!(std::abs(rotation.norm() - 1.0) <= kGreatestDeviation)) throw DamagedData("a quaternion is no rotation");
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << values[0], values[1], values[2];
  T.linear() = rotation.normalized().toRotationMatrix();
  return T;
}

template <typename Decoder>
PoseMessage readPose(Decoder& decoder, const std::string& type) {
  PoseMessage pose;
  pose.header = readHeader(decoder);
  if (type == kOdometry) pose.child_frame_id = readFrame(decoder);
  pose.T_frame_body = readTransform(decoder);
  return pose;
}

template <typename Decoder>
std::vector<TransformMessage> readTransforms(Decoder& decoder) {
  constexpr std::size_t kLeastBytes = 7 * sizeof(double);
  std::vector<TransformMessage> transforms(decoder.readCount(kLeastBytes));
  for (TransformMessage& transform : transforms) {
    transform.header = readHeader(decoder);
    transform.child_frame_id = readFrame(decoder);
    transform.T_parent_child = readTransform(decoder);
  }
  return transforms;
}

/// A cloud as its message has it.
struct CloudLayout {
  std::uint64_t height = 0, width = 0, point_step = 0, row_step = 0;
  std::vector<PcdField> fields;
  std::vector<std::uint64_t> offsets;  ///< of the fields within a point
  bool big_endian = false;
  ByteView data;
};

/// Size and type of a field, by the number that stands for it. Throws DamagedData.
PcdField cloudField(const std::string& name, std::uint8_t datatype, std::uint32_t count);

template <typename Decoder>
CloudLayout readPointCloud2(Decoder& decoder) {
  constexpr std::size_t kLeastBytes = 13;
  CloudLayout cloud;
  readHeader(decoder);
  cloud.height = decoder.template read<std::uint32_t>();
  cloud.width = decoder.template read<std::uint32_t>();
  const std::size_t fields = decoder.readCount(kLeastBytes);
  for (std::size_t i = 0; i < fields; ++i) {
    const std::string name = decoder.readString();
    cloud.offsets.push_back(decoder.template read<std::uint32_t>());
    const auto datatype = decoder.template read<std::uint8_t>();
    cloud.fields.push_back(cloudField(name, datatype, decoder.template read<std::uint32_t>()));
  }
  cloud.big_endian = decoder.template read<std::uint8_t>() != 0;
  cloud.point_step = decoder.template read<std::uint32_t>();
  cloud.row_step = decoder.template read<std::uint32_t>();
  cloud.data = decoder.readBytes();
  return cloud;
}

/// These are those above by way of CDR; there only where this library was built with what reads it.
MessageHeader readCdrHeader(ByteView bytes);
CloudLayout readCdrPointCloud2(ByteView bytes);
PoseMessage readCdrPose(const std::string& type, ByteView bytes);
std::vector<TransformMessage> readCdrTransforms(ByteView bytes);

}  // namespace saw_ndt::internal
