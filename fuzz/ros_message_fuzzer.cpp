// Messages of ROS 1 and ROS 2; the first byte chooses type and encoding.
#include "fuzzed_scan_file.h"
#include "io/pcd_fields.h"
#include "io/ros_messages.h"

namespace saw_ndt::internal {
namespace {

void decode(unsigned kind, ByteView bytes, MessageEncoding encoding) {
  constexpr const char* kPoseTypes[] = {"geometry_msgs/PoseStamped", "geometry_msgs/PoseWithCovarianceStamped",
                                        "nav_msgs/Odometry"};
  if (kind == 0) {
    requireConsistent(scanPointsOf("message", decodePointCloud2(bytes, encoding)));
  } else if (kind <= 3) {
    require(decodePose(kPoseTypes[kind - 1], bytes, encoding).T_frame_body.matrix().allFinite(), "poses are finite");
  } else if (kind == 4) {
    for (const TransformMessage& transform : decodeTransforms(bytes, encoding)) {
      require(transform.T_parent_child.matrix().allFinite(), "transforms are finite");
    }
  } else {
    decodeHeader(bytes, encoding);
  }
}

}  // namespace
}  // namespace saw_ndt::internal

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace saw_ndt::internal;
  if (size == 0) return 0;
  try {
    decode(data[0] / 2 % 6, {data + 1, size - 1}, data[0] % 2 == 0 ? MessageEncoding::ROS1 : MessageEncoding::CDR);
  } catch (const DamagedData&) {
  } catch (const saw_ndt::Error&) {  // of a cloud without coordinates
  }
  return 0;
}
