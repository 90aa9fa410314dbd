#include "saw_ndt/io/point_cloud_file.h"

#include <pcl/common/point_tests.h>
#include <pcl/console/print.h>
#include <pcl/conversions.h>
#include <pcl/io/pcd_io.h>

#include <algorithm>
#include <new>
#include <type_traits>

#include "common/atomic_output.h"
#include "io/pcd_header.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/io/kitti.h"

namespace saw_ndt {

using namespace internal;

namespace {

/// Keeps PCL from printing what an Error says already.
class QuietPcl {
 public:
  QuietPcl() { pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS); }
  ~QuietPcl() { pcl::console::setVerbosityLevel(level_); }
  QuietPcl(const QuietPcl&) = delete;
  QuietPcl& operator=(const QuietPcl&) = delete;

 private:
  pcl::console::VERBOSITY_LEVEL level_ = pcl::console::getVerbosityLevel();
};

bool isKittiScan(const std::filesystem::path& path) { return path.extension() == ".bin"; }

void requireKnownExtension(const std::filesystem::path& path) {
  if (isKittiScan(path) || path.extension() == ".pcd") return;
  throw Error(path.string(), "", "the name of a point cloud must end in .pcd or .bin");
}

void requireField(const std::filesystem::path& path, const PcdHeader& header, const std::string& name, char type,
                  bool may_be_absent) {
  const auto field = std::find_if(header.fields.begin(), header.fields.end(),
                                  [&](const PcdField& candidate) { return candidate.name == name; });
  if (field == header.fields.end()) {
    if (!may_be_absent) throw Error(path.string(), "", "has no field " + name);
  } else if (field->type != type || field->size != 4 || field->count != 1) {
    throw Error(path.string(), "", "the field " + name + " is no " + (type == 'F' ? "float32" : "uint32"));
  }
}

template <typename PointT>
pcl::PointCloud<PointT> readPcd(const std::filesystem::path& path) {
  const PcdHeader header = readPcdHeader(path);
  for (const char* name : {"x", "y", "z"}) requireField(path, header, name, 'F', false);
  if constexpr (std::is_same_v<PointT, pcl::PointXYZI>) requireField(path, header, "intensity", 'F', true);
  if constexpr (std::is_same_v<PointT, pcl::PointXYZL>) requireField(path, header, "label", 'U', false);

  const QuietPcl quiet;
  pcl::PCLPointCloud2 fields;
  try {
    if (pcl::PCDReader().read(path.string(), fields) < 0) throw Error(path.string(), "", "is damaged");
  } catch (const pcl::PCLException& failure) {
    throw Error(path.string(), "", failure.what());
  } catch (const std::bad_alloc&) {
    throw Error(path.string(), "", "is damaged, or too large for the memory");
  }
  pcl::PointCloud<PointT> cloud;
  pcl::fromPCLPointCloud2(fields, cloud);
  return cloud;
}

}  // namespace

template <typename PointT>
pcl::PointCloud<PointT> readPointCloud(const std::filesystem::path& path) {
  requireKnownExtension(path);
  if (!isKittiScan(path)) return readPcd<PointT>(path);
  if constexpr (std::is_same_v<PointT, pcl::PointXYZL>) {
    throw Error(path.string(), "", "a KITTI scan holds no labels");
  } else {
    pcl::PointCloud<PointT> cloud;
    for (const LidarPoint& point : readKittiScan(path)) {
      PointT& added = cloud.emplace_back(point.x, point.y, point.z);
      if constexpr (std::is_same_v<PointT, pcl::PointXYZI>) added.intensity = point.intensity;
      cloud.is_dense = cloud.is_dense && pcl::isFinite(added);
    }
    return cloud;
  }
}

std::vector<std::string> pointCloudFields(const std::filesystem::path& path) {
  requireKnownExtension(path);
  if (isKittiScan(path)) return {"x", "y", "z", "intensity"};
  std::vector<std::string> names;
  for (const PcdField& field : readPcdHeader(path).fields) names.push_back(field.name);
  return names;
}

template <typename PointT>
void writePcd(const std::filesystem::path& path, const pcl::PointCloud<PointT>& cloud) {
  pcl::PCLPointCloud2 fields;
  pcl::toPCLPointCloud2(cloud, fields);
  writePcd(path, fields, cloud.sensor_origin_, cloud.sensor_orientation_);
}

void writePcd(const std::filesystem::path& path, const pcl::PCLPointCloud2& cloud, const Eigen::Vector4f& sensor_origin,
              const Eigen::Quaternionf& sensor_orientation) {
  if (cloud.width == 0 || cloud.height == 0) {
    throw Error(path.string(), "", "a cloud without points cannot be written as PCD");
  }
  AtomicOutput output(path);
  const QuietPcl quiet;
  if (pcl::PCDWriter().writeBinaryCompressed(output.stream(), cloud, sensor_origin, sensor_orientation) < 0) {
    throw Error(path.string(), "", "PCL could not write it");
  }
  output.commit();
}

template pcl::PointCloud<pcl::PointXYZ> readPointCloud<pcl::PointXYZ>(const std::filesystem::path&);
template pcl::PointCloud<pcl::PointXYZI> readPointCloud<pcl::PointXYZI>(const std::filesystem::path&);
template pcl::PointCloud<pcl::PointXYZL> readPointCloud<pcl::PointXYZL>(const std::filesystem::path&);
template void writePcd<pcl::PointXYZ>(const std::filesystem::path&, const pcl::PointCloud<pcl::PointXYZ>&);
template void writePcd<pcl::PointXYZI>(const std::filesystem::path&, const pcl::PointCloud<pcl::PointXYZI>&);
template void writePcd<pcl::PointXYZL>(const std::filesystem::path&, const pcl::PointCloud<pcl::PointXYZL>&);

}  // namespace saw_ndt
