#include "drives/bag_poses.h"

#include <pcl/console/print.h>

#include <algorithm>

#include "common/pose_interpolation.h"
#include "io/ros_messages.h"
#include "io/stamp_seconds.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

namespace {

constexpr char kTransforms[] = "tf";
constexpr char kNoPoses[] = "none";
constexpr std::string_view kFixedTopic = "tf_static";

bool isOfFixedTransforms(const std::string& topic) {
  return topic.size() >= kFixedTopic.size() &&
         topic.compare(topic.size() - kFixedTopic.size(), kFixedTopic.size(), kFixedTopic) == 0;
}

}  // namespace

std::string listOf(const std::vector<MessageTopic>& topics) {
  std::string text;
  for (const MessageTopic& topic : topics) {
    text += (text.empty() ? "" : ", ") + topic.name + " (" + topic.type + ", " + std::to_string(topic.messages) +
            (topic.messages == 1 ? " message)" : " messages)");
  }
  return text.empty() ? "none" : text;
}

double stampOf(double header_stamp_s, const MessageEntry& entry) {
  return header_stamp_s != 0.0 ? header_stamp_s : stampSeconds(entry.log_time_ns);
}

BagPoses::BagPoses(MessageFile& file, const RecordingOptions& options, std::function<std::string()> lidar_frame)
    : file_(file), fixed_frame_(options.fixed_frame), ask_lidar_frame_(std::move(lidar_frame)) {
  // Poses of a file of their own take the place of those of the bag.
  if (options.pose_topic == kNoPoses || !options.poses_file.empty()) return;
  std::vector<MessageTopic> pose_topics;
  for (std::uint32_t i = 0; i < file.topics().size(); ++i) {
    const MessageTopic& topic = file.topics()[i];
    if (topic.messages == 0) continue;
    if (isTransformsType(topic.type)) transform_topics_.push_back(i);
    if (isPoseType(topic.type)) pose_topics.push_back(topic);
  }
  if (options.pose_topic == kTransforms) {
    if (transform_topics_.empty()) {
      throw Error(file.path().string(), "", "has no topic of transforms; its topics: " + listOf(file.topics()));
    }
    source_ = Source::TRANSFORMS;
  } else if (!options.pose_topic.empty()) {
    chooseTopic(options.pose_topic);
  } else if (pose_topics.size() > 1) {
    throw Error(file.path().string(), "",
                "has several topics of poses, choose one, tf or none with -pose-topic: " + listOf(pose_topics));
  } else if (!pose_topics.empty()) {
    chooseTopic(pose_topics.front().name);
  } else if (!transform_topics_.empty()) {
    source_ = Source::MOVING_TRANSFORMS;
  }
}

void BagPoses::chooseTopic(const std::string& name) {
  const auto named = std::find_if(file_.topics().begin(), file_.topics().end(), [&](const MessageTopic& topic) {
    return topic.name == name && isPoseType(topic.type);
  });
  if (named == file_.topics().end()) {
    throw Error(file_.path().string(), "", "has no poses on " + name + "; its topics: " + listOf(file_.topics()));
  }
  source_ = Source::TOPIC;
  topic_ = static_cast<std::uint32_t>(named - file_.topics().begin());
}

template <typename Take>
void BagPoses::forEachMessage(const std::vector<std::uint32_t>& topics, Take take) {
  for (const MessageEntry& entry : file_.index(topics)) {
    try {
      take(entry, file_.read(entry));
    } catch (const DamagedData&) {
    } catch (const Error&) {
    }
  }
}

void BagPoses::read() {
  if (read_ || source_ == Source::NONE) return;
  lidar_frame_ = ask_lidar_frame_();
  tree_ = TransformTree();
  if (source_ == Source::TOPIC) {
    readTrajectory();
    // Without a chain of transforms to it the body is taken to be the LiDAR.
    if (body_frame_ == lidar_frame_) body_frame_.clear();
    if (!body_frame_.empty()) readTransforms();
    if (!tree_.connects(body_frame_, lidar_frame_)) {
      if (!body_frame_.empty()) {
        PCL_WARN("[saw_ndt::openBag] %s: no transforms lead from %s to %s: its poses are taken to be the LiDAR's.\n",
                 file_.path().c_str(), body_frame_.c_str(), lidar_frame_.c_str());
      }
      body_frame_.clear();
    }
    if (trajectory_.empty()) source_ = Source::NONE;
  } else {
    readTransforms();
    chooseFixedFrame();
  }
  read_ = true;
}

void BagPoses::readTrajectory() {
  const MessageTopic& topic = file_.topics()[topic_];
  forEachMessage({topic_}, [&](const MessageEntry& entry, ByteView bytes) {
    const PoseMessage pose = decodePose(topic.type, bytes, topic.encoding);
    if (trajectory_.empty()) body_frame_ = pose.child_frame_id;
    trajectory_.push_back({stampOf(pose.header.stamp_s, entry), pose.T_frame_body});
  });
  std::stable_sort(trajectory_.begin(), trajectory_.end(),
                   [](const StampedPose& a, const StampedPose& b) { return a.stamp_s < b.stamp_s; });
}

void BagPoses::readTransforms() {
  forEachMessage(transform_topics_, [&](const MessageEntry& entry, ByteView bytes) {
    const MessageTopic& topic = file_.topics()[entry.topic];
    for (const TransformMessage& transform : decodeTransforms(bytes, topic.encoding)) {
      const std::string& parent = transform.header.frame_id;
      if (isOfFixedTransforms(topic.name)) {
        tree_.setFixed(parent, transform.child_frame_id, transform.T_parent_child);
      } else {
        tree_.add(parent, transform.child_frame_id, stampOf(transform.header.stamp_s, entry), transform.T_parent_child);
      }
    }
  });
  tree_.sort();
}

void BagPoses::chooseFixedFrame() {
  fixed_frame_.erase(0, std::min(fixed_frame_.find_first_not_of('/'), fixed_frame_.size()));
  if (fixed_frame_.empty()) fixed_frame_ = tree_.rootOf(lidar_frame_);
  if (source_ == Source::MOVING_TRANSFORMS) {
    if (!tree_.moves(fixed_frame_, lidar_frame_)) source_ = Source::NONE;
    return;
  }
  if (fixed_frame_ != lidar_frame_ && tree_.connects(fixed_frame_, lidar_frame_)) return;
  std::string frames;
  for (const std::string& frame : tree_.frames()) frames += (frames.empty() ? "" : ", ") + frame;
  throw Error(file_.path().string(), "",
              "tf has no chain from " + (fixed_frame_ == lidar_frame_ ? std::string("a frame") : fixed_frame_) +
                  " to the frame of the clouds, '" + lidar_frame_ + "'; its frames: " + frames);
}

bool BagPoses::any() {
  read();
  return source_ != Source::NONE;
}

std::optional<Eigen::Isometry3d> BagPoses::at(double stamp_s) {
  read();
  if (source_ == Source::NONE) return std::nullopt;
  if (source_ != Source::TOPIC) return tree_.find(fixed_frame_, lidar_frame_, stamp_s);
  std::optional<Eigen::Isometry3d> T_map_body = poseAt(trajectory_, stamp_s, kLongestPoseGap_s);
  if (!T_map_body || body_frame_.empty()) return T_map_body;
  const std::optional<Eigen::Isometry3d> T_body_lidar = tree_.find(body_frame_, lidar_frame_, stamp_s);
  if (!T_body_lidar) return std::nullopt;
  return normalizedRotation(*T_map_body * *T_body_lidar);
}

}  // namespace saw_ndt::internal
