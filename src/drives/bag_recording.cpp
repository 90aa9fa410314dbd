#include "drives/bag_recording.h"

#include <pcl/console/print.h>

#include <algorithm>

#include "drives/bag_poses.h"
#include "io/pcd_fields.h"
#include "io/ros_messages.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

namespace fs = std::filesystem;

namespace {

// Enough for a header; the rest of a cloud is not looked at for its stamp.
constexpr std::size_t kHeaderBytes = 4096;

std::string nameOf(const fs::path& path) {
  const fs::path absolute = fs::absolute(path).lexically_normal();
  const fs::path named = absolute.has_filename() ? absolute : absolute.parent_path();
  std::error_code ignored;
  return (fs::is_directory(named, ignored) ? named.filename() : named.stem()).string();
}

std::uint32_t cloudTopic(const MessageFile& file, const std::string& name) {
  std::vector<std::uint32_t> found;
  std::vector<MessageTopic> listed;
  for (std::uint32_t i = 0; i < file.topics().size(); ++i) {
    const MessageTopic& topic = file.topics()[i];
    if (topic.type != kPointCloud2 || topic.messages == 0 || (!name.empty() && topic.name != name)) continue;
    found.push_back(i);
    listed.push_back(topic);
  }
  if (found.empty()) {
    const std::string where = name.empty() ? std::string() : " on " + name;
    throw Error(file.path().string(), "",
                "has no messages of " + std::string(kPointCloud2) + where + "; its topics: " + listOf(file.topics()));
  }
  if (found.size() > 1) {
    throw Error(file.path().string(), "",
                "has several topics of point clouds, choose one with -topic: " + listOf(listed));
  }
  return found.front();
}

class BagRecording : public Recording {
 public:
  BagRecording(const fs::path& path, const RecordingOptions& options)
      : Recording(path, nameOf(path)), file_(openMessageFile(path)) {
    if (!file_->warning().empty()) {
      PCL_WARN("[saw_ndt::openBag] %s: %s.\n", path.c_str(), file_->warning().c_str());
    }
    const std::uint32_t topic = cloudTopic(*file_, options.topic);
    topic_ = file_->topics()[topic];
    try {
      requireEncoding(topic_.encoding);
    } catch (const DamagedData& reason) {
      throw Error(path.string(), topic_.name, reason.what());
    }
    entries_ = file_->index({topic});
    poses_ = std::make_unique<BagPoses>(*file_, options, [this] { return lidarFrame(); });
  }

  int scanCount() const override { return static_cast<int>(entries_.size()); }

  std::string scanName(int scan) const override {
    requireScan(scan);
    return topic_.name + " message " + std::to_string(scan);
  }

  void readScan(int scan, ScanPoints& points) const override {
    const ByteView bytes = file_->read(entries_[requireScan(scan)]);
    try {
      points = scanPointsOf(path().string() + ": " + scanName(scan), decodePointCloud2(bytes, topic_.encoding));
    } catch (const DamagedData& damage) {
      throw Error(path().string(), scanName(scan), damage.what());
    }
  }

  bool hasStamps() const override { return true; }

  const std::vector<double>& stamps() const override {
    if (!stamps_s_.empty()) return stamps_s_;
    stamps_s_.reserve(entries_.size());
    for (const MessageEntry& entry : entries_) stamps_s_.push_back(stampOf(headerOf(entry).stamp_s, entry));
    return stamps_s_;
  }

  std::string stampsPlace() const override { return path().string() + ": " + topic_.name; }

  bool hasPoses() const override { return poses_->any(); }

  std::optional<Eigen::Isometry3d> referencePose(int scan) const override {
    return poses_->at(stamps()[requireScan(scan)]);
  }

 private:
  /// That of a message; one without stamp and frame where it cannot be read.
  MessageHeader headerOf(const MessageEntry& entry) const {
    try {
      return decodeHeader(file_->readHead(entry, kHeaderBytes), topic_.encoding);
    } catch (const DamagedData&) {
    } catch (const Error&) {
    }
    return {};
  }

  /// The frame of the first cloud that tells it.
  std::string lidarFrame() const {
    for (const MessageEntry& entry : entries_) {
      std::string frame = headerOf(entry).frame_id;
      if (!frame.empty()) return frame;
    }
    return "";
  }

  std::unique_ptr<MessageFile> file_;
  MessageTopic topic_;
  std::vector<MessageEntry> entries_;
  std::unique_ptr<BagPoses> poses_;
  mutable std::vector<double> stamps_s_;  // empty: not read yet
};

}  // namespace

std::unique_ptr<Recording> openBag(const fs::path& path, const RecordingOptions& options) {
  return std::make_unique<BagRecording>(path, options);
}

}  // namespace saw_ndt::internal
