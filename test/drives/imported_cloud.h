#pragma once

#include <string>
#include <vector>

#include "io/pcd_text.h"
#include "map/map_fixtures.h"
#include "temporary_folder.h"

namespace saw_ndt {

using LabelledCloud = pcl::PointCloud<pcl::PointXYZL>;

/// x y z (float) and, where it is asked for, label of a cloud as the fields of a file to write.
inline std::vector<TestField> fieldsOf(const LabelledCloud& cloud, bool labels = true) {
  std::vector<TestField> fields = {{"x", 'F', 4, 1, {}}, {"y", 'F', 4, 1, {}}, {"z", 'F', 4, 1, {}}};
  if (labels) fields.push_back({"label", 'U', 1, 1, {}});
  for (const pcl::PointXYZL& point : cloud) {
    const double values[] = {point.x, point.y, point.z, static_cast<double>(point.label)};
    for (std::size_t i = 0; i < fields.size(); ++i) fields[i].values.push_back(values[i]);
  }
  return fields;
}

/// A PCD text's points behind the head of a PLY file of the same fields.
inline std::string plyText(const LabelledCloud& cloud, bool binary) {
  std::string text = std::string("ply\nformat ") + (binary ? "binary_little_endian" : "ascii") +
                     " 1.0\nelement vertex " + std::to_string(cloud.size()) +
                     "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar label\nend_header\n";
  const std::string data = binary ? "binary" : "ascii";
  const std::string pcd = pcdText(fieldsOf(cloud), data);
  return text + pcd.substr(pcd.find("DATA " + data) + 6 + data.size());
}

inline std::string savedBytes(const WeightedVoxelMap& map) {
  const TemporaryFolder folder;
  map.save((folder.path() / "a.map").string());
  return contentOf(folder.path() / "a.map");
}

}  // namespace saw_ndt
