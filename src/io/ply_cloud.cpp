#include "io/ply_cloud.h"

#include <algorithm>

#include "common/input_file.h"
#include "io/pcd_ascii.h"
#include "io/ply_header.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

void reverseBytes(PcdCloud& cloud) {
  for (const PcdColumn& column : cloud.columns) {
    unsigned char* at = cloud.bytes.data() + column.offset;
    for (std::size_t point = 0; point < cloud.points; ++point, at += column.stride_bytes) {
      std::reverse(at, at + column.field.size);
    }
  }
}

PcdCloud readPlyCloud(const std::filesystem::path& path) {
  const PlyHeader header = readPlyHeader(path);
  std::ifstream stream = openInputFile(path);
  stream.seekg(static_cast<std::streamoff>(header.cloud.data_offset));
  PcdCloud cloud = cloudOfRows(path, header.cloud, stream);
  if (header.big_endian) reverseBytes(cloud);
  return cloud;
}

}  // namespace saw_ndt::internal
