#include "io/ros_messages.h"

#include "io/ros_message_layouts.h"

namespace saw_ndt::internal {

namespace {

/// The Decoder of what ROS 1 writes: little-endian numbers without gaps.
class Ros1Decoder : public ByteReader {
 public:
  static constexpr bool kIsRos1 = true;

  using ByteReader::ByteReader;

  std::size_t readCount(std::size_t least_bytes) {
    const std::size_t count = read<std::uint32_t>();
    if (count > remaining() / least_bytes) throw DamagedData("a list is longer than its message");
    return count;
  }
  ByteView readBytes() { return bytes(readCount(1)); }
};

/// Calls that of the two readers which the encoding needs.
template <typename ReadRos1, typename ReadCdr>
auto decode(ByteView bytes, MessageEncoding encoding, ReadRos1 read_ros1, [[maybe_unused]] ReadCdr read_cdr) {
  requireEncoding(encoding);
#if SAW_NDT_HAS_FASTCDR
  if (encoding == MessageEncoding::CDR) return read_cdr();
#endif
  Ros1Decoder decoder(bytes);
  return read_ros1(decoder);
}

/// Throws DamagedData unless the points lie within the data and the fields within a point.
void requireWithinData(const CloudLayout& cloud) {
  for (std::size_t i = 0; i < cloud.fields.size(); ++i) {
    if (cloud.offsets[i] + cloud.fields[i].bytes() > cloud.point_step) {
      throw DamagedData("the field " + cloud.fields[i].name + " does not lie within a point of " +
                        std::to_string(cloud.point_step) + " bytes");
    }
  }
  if (cloud.width == 0 || cloud.height == 0) return;
  const std::uint64_t row_bytes = cloud.width * cloud.point_step;  // both of 32 bits
  const std::uint64_t before = cloud.height > 1 ? cloud.row_step : 0;
  const bool fits = cloud.point_step > 0 && row_bytes <= cloud.data.size &&
                    (cloud.height == 1 || before >= row_bytes) &&
                    (before == 0 || cloud.height - 1 <= (cloud.data.size - row_bytes) / before);
  if (fits) return;
  throw DamagedData("the " + std::to_string(cloud.data.size) + " bytes of the cloud are not its " +
                    std::to_string(cloud.height) + " rows of " + std::to_string(cloud.width) + " points of " +
                    std::to_string(cloud.point_step) + " bytes");
}

void turnBytesAround(PcdCloud& cloud) {
  for (const PcdColumn& column : cloud.columns) {
    for (std::size_t point = 0; point < cloud.points; ++point) {
      unsigned char* first = cloud.bytes.data() + column.offset + point * column.stride_bytes;
      for (std::uint64_t i = 0; i < column.field.count; ++i, first += column.field.size) {
        std::reverse(first, first + column.field.size);
      }
    }
  }
}

}  // namespace

PcdField cloudField(const std::string& name, std::uint8_t datatype, std::uint32_t count) {
  constexpr std::pair<std::uint64_t, char> kTypes[] = {{1, 'I'}, {1, 'U'}, {2, 'I'}, {2, 'U'},
                                                       {4, 'I'}, {4, 'U'}, {4, 'F'}, {8, 'F'}};
  if (datatype < 1 || datatype > std::size(kTypes)) {
    throw DamagedData("the field " + name.substr(0, 40) + " has the unknown type " + std::to_string(datatype));
  }
  const auto& [size, type] = kTypes[datatype - 1];
  // Old drivers leave the count of single values at 0.
  return {name, size, type, std::max<std::uint64_t>(count, 1)};
}

bool isPoseType(const std::string& type) {
  return type == kPoseStamped || type == kPoseWithCovarianceStamped || type == kOdometry;
}

bool isTransformsType(const std::string& type) { return type == "tf2_msgs/TFMessage" || type == "tf/tfMessage"; }

void requireEncoding(MessageEncoding encoding) {
  if (encoding == MessageEncoding::OTHER) throw DamagedData("the encoding of the messages is not known");
#if !SAW_NDT_HAS_FASTCDR
  if (encoding == MessageEncoding::CDR) {
    throw DamagedData("messages of ROS 2 cannot be read, since saw_ndt was built without libfastcdr-dev");
  }
#endif
}

MessageHeader decodeHeader(ByteView bytes, MessageEncoding encoding) {
  return decode(
      bytes, encoding, [](Ros1Decoder& decoder) { return readHeader(decoder); }, [&] { return readCdrHeader(bytes); });
}

PcdCloud decodePointCloud2(ByteView bytes, MessageEncoding encoding) {
  CloudLayout layout = decode(
      bytes, encoding, [](Ros1Decoder& decoder) { return readPointCloud2(decoder); },
      [&] { return readCdrPointCloud2(bytes); });
  if (layout.height > 1 && layout.row_step == 0) layout.row_step = layout.width * layout.point_step;
  requireWithinData(layout);
  PcdCloud cloud;
  cloud.width = layout.width;
  cloud.height = layout.height;
  cloud.points = layout.width * layout.height;
  for (std::size_t i = 0; i < layout.fields.size(); ++i) {
    cloud.columns.push_back({layout.fields[i], layout.offsets[i], layout.point_step});
  }
  if (cloud.points == 0) return cloud;
  // Rows may have a gap behind them.
  const std::uint64_t row_bytes = layout.width * layout.point_step;
  cloud.bytes.reserve(row_bytes * layout.height);
  for (std::uint64_t row = 0; row < layout.height; ++row) {
    const unsigned char* first = layout.data.data + row * layout.row_step;
    cloud.bytes.insert(cloud.bytes.end(), first, first + row_bytes);
  }
  if (layout.big_endian) turnBytesAround(cloud);
  return cloud;
}

PoseMessage decodePose(const std::string& type, ByteView bytes, MessageEncoding encoding) {
  return decode(
      bytes, encoding, [&](Ros1Decoder& decoder) { return readPose(decoder, type); },
      [&] { return readCdrPose(type, bytes); });
}

std::vector<TransformMessage> decodeTransforms(ByteView bytes, MessageEncoding encoding) {
  return decode(
      bytes, encoding, [](Ros1Decoder& decoder) { return readTransforms(decoder); },
      [&] { return readCdrTransforms(bytes); });
}

}  // namespace saw_ndt::internal
