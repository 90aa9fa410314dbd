#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "io/byte_reader.h"
#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

/// How the bytes of a message are written.
enum class MessageEncoding {
  ROS1,  ///< by ROS 1
  CDR,   ///< by ROS 2
  OTHER  ///< in a way that is not read here
};

/// A topic of a recording.
struct MessageTopic {
  std::string name;
  std::string type;  ///< such as sensor_msgs/PointCloud2, in this form for both versions of ROS
  MessageEncoding encoding = MessageEncoding::OTHER;
  std::size_t messages = 0;
};

/// A message of a recording and where it lies.
struct MessageEntry {
  std::uint32_t topic = 0;       ///< index into MessageFile::topics()
  std::uint32_t file = 0;        ///< of several, where the recording has several
  std::int64_t log_time_ns = 0;  ///< when it was recorded
  std::uint64_t chunk = 0;       ///< these two as the file has them
  std::uint64_t place = 0;
};

/// A file of recorded messages, or several that belong together: what is in memory is where the messages lie, never
/// more of them than those of one chunk. Not to be shared by threads.
class MessageFile {
 public:
  virtual ~MessageFile() = default;
  MessageFile(const MessageFile&) = delete;
  MessageFile& operator=(const MessageFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  const std::vector<MessageTopic>& topics() const { return topics_; }
  /// What of the file cannot be read, and why; empty where all can.
  const std::string& warning() const { return warning_; }

  /// The messages of some topics by the times when they were recorded.
  /// @param topics  indices into topics()
  std::vector<MessageEntry> index(const std::vector<std::uint32_t>& topics);

  /// The bytes of a message; they stay until the next call. Throws Error where it is damaged.
  ByteView read(const MessageEntry& entry);
  /// At least the first bytes of a message, or all where it is shorter. Costs less where the file is such that they can
  /// be read alone; whether the message is whole is not looked at then.
  ByteView readHead(const MessageEntry& entry, std::size_t bytes);

 protected:
  explicit MessageFile(std::filesystem::path path) : path_(std::move(path)) {}

  /// The topic of this name, type (in either form) and encoding, a new one where there is none yet.
  std::uint32_t topicOf(const std::string& name, const std::string& type, MessageEncoding encoding);
  /// Adds to warning().
  void warn(const std::string& what);
  /// What entries are called in errors.
  virtual std::string placeOf(const MessageEntry& entry) const = 0;
  /// Appends the entries of the topics that are wanted, in any order.
  virtual void collect(const std::vector<bool>& wanted, std::vector<MessageEntry>& entries) = 0;
  /// read() and readHead(), which makes an Error of DamagedData.
  virtual ByteView readMessage(const MessageEntry& entry) = 0;
  virtual ByteView readStart(const MessageEntry& entry, std::size_t bytes) = 0;

  std::vector<MessageTopic> topics_;

 private:
  std::filesystem::path path_;
  std::string warning_;
  std::map<std::tuple<std::string, std::string, MessageEncoding>, std::uint32_t> numbers_;  // of the topics
};

/// Whether this is a recording of ROS: a file that begins as a bag of ROS 1 or 2 does, or a folder of such files of
/// ROS 2 (.db3, .mcap) or with metadata.yaml.
SAW_NDT_EXPORT bool isBag(const std::filesystem::path& path);

/// Opens such a recording. Throws Error where it is none, where nothing of it can be read, or where this library was
/// built without what reads it.
SAW_NDT_EXPORT std::unique_ptr<MessageFile> openMessageFile(const std::filesystem::path& path);

}  // namespace saw_ndt::internal
