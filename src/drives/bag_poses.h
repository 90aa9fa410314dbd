#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "drives/transform_tree.h"
#include "io/message_file.h"
#include "saw_ndt/drives/recording.h"

namespace saw_ndt::internal {

/// The topics of a file in words, for errors: names, types, numbers of messages.
std::string listOf(const std::vector<MessageTopic>& topics);

/// The stamp (s) of a message: its header's or, where that is 0, when it was recorded.
double stampOf(double header_stamp_s, const MessageEntry& entry);

/// The reference poses of a bag. Damaged messages are passed over.
class BagPoses {
 public:
  /// Chooses what poses come from; nothing is read yet. Throws Error where that cannot be done.
  /// @param file         must live as long as this
  /// @param lidar_frame  tells the frame of the clouds, empty where it is not known
  BagPoses(MessageFile& file, const RecordingOptions& options, std::function<std::string()> lidar_frame);

  /// Whether there are any. Here and below the first call reads them. Throws Error where `tf` is asked for and does not
  /// have the frames.
  bool any();
  /// T_map_lidar at a moment; nothing where none is known.
  std::optional<Eigen::Isometry3d> at(double stamp_s);

 private:
  enum class Source { NONE, TOPIC, TRANSFORMS, MOVING_TRANSFORMS };

  void chooseTopic(const std::string& name);
  void read();
  void readTrajectory();
  void readTransforms();
  void chooseFixedFrame();
  /// Calls take(entry, bytes) with all messages of some topics; what it throws is passed over.
  template <typename Take>
  void forEachMessage(const std::vector<std::uint32_t>& topics, Take take);

  MessageFile& file_;
  std::string fixed_frame_;
  std::function<std::string()> ask_lidar_frame_;
  Source source_ = Source::NONE;
  std::uint32_t topic_ = 0;                      // where poses come from one
  std::vector<std::uint32_t> transform_topics_;  // all of tf
  bool read_ = false;
  std::string lidar_frame_, body_frame_;  // the latter empty where poses are the LiDAR's
  std::vector<StampedPose> trajectory_;   // of the body
  TransformTree tree_;
};

}  // namespace saw_ndt::internal
