#pragma once

#include <zlib.h>

#include <optional>
#include <string>
#include <vector>

#include "io/message_bytes.h"

namespace saw_ndt::internal {

/// Builds an .mcap file record by record.
class McapWriter {
 public:
  struct Message {
    std::uint16_t channel;
    std::uint64_t log_time_ns;
    std::string data;
  };

  McapWriter() { add(1, sized("ros2") + sized("test")); }

  static std::string record(std::uint8_t kind, const std::string& content) {
    return bytesOf(kind) + bytesOf(std::uint64_t{content.size()}) + content;
  }
  static std::string channel(std::uint16_t number, const std::string& topic, const std::string& type,
                             const std::string& encoding = "cdr") {
    return record(3, bytesOf(number) + sized(type) + sized("ros2msg") + sized("")) +
           record(4, bytesOf(number) + bytesOf(number) + sized(topic) + sized(encoding) + sized(""));
  }
  static std::string message(const Message& message) {
    return record(5, bytesOf(message.channel) + bytesOf(std::uint32_t{0}) + bytesOf(message.log_time_ns) +
                         bytesOf(message.log_time_ns) + message.data);
  }

  McapWriter& add(std::uint8_t kind, const std::string& content) { return addRecords(record(kind, content)); }
  McapWriter& addRecords(const std::string& records) {
    bytes_ += records;
    return *this;
  }
  /// An uncompressed chunk of channels and messages, with the index of its messages.
  McapWriter& addChunk(const std::string& channels, const std::vector<Message>& messages, bool index = true,
                       std::optional<std::uint32_t> crc = std::nullopt) {
    chunk_places_.push_back(bytes_.size());
    std::string records = channels, indices;
    for (const Message& one : messages) {
      indices += record(7, bytesOf(one.channel) + bytesOf(std::uint32_t{16}) + bytesOf(one.log_time_ns) +
                               bytesOf(std::uint64_t{records.size()}));
      records += message(one);
    }
    const auto* first = reinterpret_cast<const unsigned char*>(records.data());
    const auto sum = static_cast<std::uint32_t>(crc32_z(0, first, records.size()));
    const std::uint64_t size = records.size();
    add(6, bytesOf(std::uint64_t{0}) + bytesOf(std::uint64_t{0}) + bytesOf(size) + bytesOf(crc.value_or(sum)) +
               sized("") + bytesOf(size) + records);
    return index ? addRecords(indices) : *this;
  }

  std::string withoutSummary() const { return kMagic + bytes_; }
  std::string whole(const std::string& channels) const {
    std::string result = withoutSummary() + record(15, bytesOf(std::uint32_t{0}));
    const std::uint64_t summary = result.size();
    result += channels;
    for (const std::uint64_t place : chunk_places_) {
      result += record(8, std::string(16, '\0') + bytesOf(place + kMagic.size()) + std::string(40, '\0'));
    }
    return result + record(2, bytesOf(summary) + bytesOf(std::uint64_t{0}) + bytesOf(std::uint32_t{0})) + kMagic;
  }

 private:
  inline static const std::string kMagic = std::string("\x89MCAP0\r\n", 8);

  std::string bytes_;
  std::vector<std::uint64_t> chunk_places_;
};

}  // namespace saw_ndt::internal
