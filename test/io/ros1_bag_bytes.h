#pragma once

#include <string>
#include <vector>

#include "io/message_bytes.h"

namespace saw_ndt::internal {

/// Builds a bag of ROS 1.
class Ros1BagWriter {
 public:
  struct Topic {
    std::string name, type;
  };
  struct Message {
    std::uint32_t topic, seconds, nanoseconds;
    std::string data;
  };

  explicit Ros1BagWriter(const std::vector<Topic>& topics) : topics_(topics) {}

  static std::string field(const std::string& name, const std::string& value) { return sized(name + "=" + value); }
  static std::string record(char kind, const std::string& fields, const std::string& data) {
    return sized(field("op", std::string(1, kind)) + fields) + sized(data);
  }

  /// A chunk that is not compressed, with its index.
  Ros1BagWriter& addChunk(const std::vector<Message>& messages) {
    std::string records;
    std::vector<std::string> indices(topics_.size());
    for (const Message& message : messages) {
      const std::string time = bytesOf(message.seconds) + bytesOf(message.nanoseconds);
      indices[message.topic] += time + bytesOf(static_cast<std::uint32_t>(records.size()));
      records += record(2, field("conn", bytesOf(message.topic)) + field("time", time), message.data);
    }
    chunk_places_.push_back(kHeadBytes + chunks_.size());
    chunks_ += record(5, field("compression", "none") + number("size", records.size()), records);
    for (std::size_t topic = 0; topic < topics_.size(); ++topic) {
      if (indices[topic].empty()) continue;
      chunks_ += record(4, number("ver", 1) + number("conn", topic) + number("count", indices[topic].size() / 12),
                        indices[topic]);
    }
    return *this;
  }

  /// @param indexed  whether the bag was closed
  std::string bytes(bool indexed = true) const {
    const std::uint64_t index_place = indexed ? kHeadBytes + chunks_.size() : 0;
    std::string head = std::string("#ROSBAG V2.0\n") +
                       sized(field("op", "\x03") + field("index_pos", bytesOf(index_place)) +
                             number("conn_count", topics_.size()) + number("chunk_count", chunk_places_.size()));
    head += sized(std::string(kHeadBytes - head.size() - 4, ' '));
    std::string index;
    for (std::size_t topic = 0; topic < topics_.size(); ++topic) {
      index += record(7, number("conn", topic) + field("topic", topics_[topic].name),
                      field("topic", topics_[topic].name) + field("type", topics_[topic].type));
    }
    for (const std::uint64_t place : chunk_places_) {
      index += record(6, number("ver", 1) + field("chunk_pos", bytesOf(place)) + number("count", 0), "");
    }
    return head + chunks_ + (indexed ? index : "");
  }

 private:
  static constexpr std::size_t kHeadBytes = 256;

  static std::string number(const std::string& name, std::size_t value) {
    return field(name, bytesOf(static_cast<std::uint32_t>(value)));
  }

  std::vector<Topic> topics_;
  std::string chunks_;
  std::vector<std::uint64_t> chunk_places_;
};

}  // namespace saw_ndt::internal
