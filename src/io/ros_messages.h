#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "io/byte_reader.h"
#include "io/message_file.h"
#include "io/pcd_cloud.h"
#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

/// What messages that were measured at a moment begin with.
struct MessageHeader {
  double stamp_s = 0.0;
  std::string frame_id;  ///< without the slash that ROS 1 may have in front
};

/// Where a body was.
struct PoseMessage {
  MessageHeader header;        ///< its frame is the one that the pose is in
  std::string child_frame_id;  ///< of the body; empty where the message does not tell
  Eigen::Isometry3d T_frame_body = Eigen::Isometry3d::Identity();
};

/// Where a frame is in another one.
struct TransformMessage {
  MessageHeader header;  ///< its frame is the parent
  std::string child_frame_id;
  Eigen::Isometry3d T_parent_child = Eigen::Isometry3d::Identity();
};

constexpr char kPointCloud2[] = "sensor_msgs/PointCloud2";

/// Whether a message of this type tells a pose or transforms.
SAW_NDT_EXPORT bool isPoseType(const std::string& type);
SAW_NDT_EXPORT bool isTransformsType(const std::string& type);
/// Throws DamagedData, which tells the package, where this library was built without what reads an encoding.
void requireEncoding(MessageEncoding encoding);

/// These decode the bytes of a message. They throw DamagedData, also where rotations are none or numbers not finite.
/// @param bytes  of any message that has a header, or its beginning
SAW_NDT_EXPORT MessageHeader decodeHeader(ByteView bytes, MessageEncoding encoding);
/// Numbers of the other byte order are turned around.
SAW_NDT_EXPORT PcdCloud decodePointCloud2(ByteView bytes, MessageEncoding encoding);
/// @param type  one of isPoseType()
SAW_NDT_EXPORT PoseMessage decodePose(const std::string& type, ByteView bytes, MessageEncoding encoding);
SAW_NDT_EXPORT std::vector<TransformMessage> decodeTransforms(ByteView bytes, MessageEncoding encoding);

}  // namespace saw_ndt::internal
