#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/byte_reader.h"
#include "io/message_file.h"

namespace saw_ndt::internal {

inline ByteView viewOf(const std::string& bytes) {
  return {reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()};
}

template <typename Number>
std::string bytesOf(Number number) {
  return std::string(reinterpret_cast<const char*>(&number), sizeof(Number));
}

/// A string with its length in front, as files have it.
inline std::string sized(const std::string& text) { return bytesOf(static_cast<std::uint32_t>(text.size())) + text; }

/// Writes a message as ROS 1 or ROS 2 does.
class MessageWriter {
 public:
  explicit MessageWriter(MessageEncoding encoding, bool big_endian = false)
      : ros1_(encoding == MessageEncoding::ROS1), big_endian_(big_endian) {}

  template <typename Number>
  MessageWriter& add(Number number) {
    while (!ros1_ && bytes_.size() % sizeof(Number) != 0) bytes_ += '\0';
    const std::string little = bytesOf(number);
    bytes_ += big_endian_ ? std::string(little.rbegin(), little.rend()) : little;
    return *this;
  }
  MessageWriter& addString(const std::string& text) {
    add(static_cast<std::uint32_t>(text.size() + (ros1_ ? 0 : 1)));
    bytes_ += text;
    if (!ros1_) bytes_ += '\0';
    return *this;
  }
  MessageWriter& addBytes(const std::string& bytes) {
    add(static_cast<std::uint32_t>(bytes.size()));
    bytes_ += bytes;
    return *this;
  }
  MessageWriter& addHeader(std::uint32_t seconds, std::uint32_t nanoseconds, const std::string& frame) {
    if (ros1_) add(std::uint32_t{7});
    return add(seconds).add(nanoseconds).addString(frame);
  }
  /// Turned about z by half a turn where `turned`.
  MessageWriter& addTransform(double x, double y, double z, bool turned = false) {
    return add(x).add(y).add(z).add(0.0).add(0.0).add(turned ? 1.0 : 0.0).add(turned ? 0.0 : 1.0);
  }

  std::string bytes() const { return ros1_ ? bytes_ : std::string(big_endian_ ? "\0\0\0\0" : "\0\1\0\0", 4) + bytes_; }

 private:
  bool ros1_, big_endian_;
  std::string bytes_;
};

/// What a cloud message states beside its points.
struct CloudForm {
  std::uint32_t height = 1, width = 2, point_step = 16, row_step = 32;
  bool big_endian = false;
  std::vector<std::pair<std::string, std::uint8_t>> fields = {{"x", 7}, {"y", 7}, {"z", 7}, {"intensity", 7}};
  std::string frame = "lidar";
};

/// A cloud whose fields are four bytes apart.
inline std::string cloudMessage(MessageWriter writer, const CloudForm& form, const std::string& data,
                                std::uint32_t seconds = 1600000000, std::uint32_t nanoseconds = 250000000) {
  writer.addHeader(seconds, nanoseconds, form.frame).add(form.height).add(form.width);
  writer.add(static_cast<std::uint32_t>(form.fields.size()));
  std::uint32_t offset = 0;
  for (const auto& [name, type] : form.fields) {
    writer.addString(name).add(offset).add(type).add(std::uint32_t{1});
    offset += 4;
  }
  writer.add(static_cast<std::uint8_t>(form.big_endian)).add(form.point_step).add(form.row_step);
  return writer.addBytes(data).add(std::uint8_t{1}).bytes();
}

/// Four floats a point.
inline std::string floatBytes(const std::vector<float>& values) {
  return std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
}

}  // namespace saw_ndt::internal
