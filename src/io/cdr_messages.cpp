#include <fastcdr/Cdr.h>
#include <fastcdr/exceptions/Exception.h>

#include "io/ros_message_layouts.h"

namespace saw_ndt::internal {

namespace {

using eprosima::fastcdr::Cdr;

/// The Decoder of what ROS 2 writes.
class CdrDecoder {
 public:
  static constexpr bool kIsRos1 = false;

  // Fast-CDR does not write to what it reads.
  explicit CdrDecoder(ByteView bytes)
      : end_(reinterpret_cast<const char*>(bytes.data) + bytes.size),
        buffer_(const_cast<char*>(reinterpret_cast<const char*>(bytes.data)), bytes.size),
        cdr_(buffer_, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR) {
    cdr_.read_encapsulation();
  }

  template <typename Number>
  Number read() {
    Number number{};
    cdr_.deserialize(number);
    return number;
  }

  std::string readString() {
    std::string text;
    cdr_.deserialize(text);
    return text;
  }

  std::size_t readCount(std::size_t least_bytes) {
    const std::size_t count = read<std::uint32_t>();
    if (count > remaining() / least_bytes) throw DamagedData("a list is longer than its message");
    return count;
  }

  ByteView readBytes() {
    const std::size_t size = readCount(1);
    return {reinterpret_cast<const unsigned char*>(cdr_.getCurrentPosition()), size};
  }

 private:
  std::size_t remaining() { return static_cast<std::size_t>(end_ - cdr_.getCurrentPosition()); }

  const char* end_;
  eprosima::fastcdr::FastBuffer buffer_;
  Cdr cdr_;
};

template <typename Read>
auto decode(ByteView bytes, Read read) {
  try {
    CdrDecoder decoder(bytes);
    return read(decoder);
  } catch (const eprosima::fastcdr::exception::Exception& exception) {
    throw DamagedData(std::string("the message is damaged or cut short: ") + exception.what());
  }
}

}  // namespace

MessageHeader readCdrHeader(ByteView bytes) {
  return decode(bytes, [](CdrDecoder& decoder) { return readHeader(decoder); });
}

CloudLayout readCdrPointCloud2(ByteView bytes) {
  return decode(bytes, [](CdrDecoder& decoder) { return readPointCloud2(decoder); });
}

PoseMessage readCdrPose(const std::string& type, ByteView bytes) {
  return decode(bytes, [&](CdrDecoder& decoder) { return readPose(decoder, type); });
}

std::vector<TransformMessage> readCdrTransforms(ByteView bytes) {
  return decode(bytes, [](CdrDecoder& decoder) { return readTransforms(decoder); });
}

}  // namespace saw_ndt::internal
