#include "saw_ndt/io/point_cloud_file.h"

#include <pcl/common/io.h>
#include <pcl/common/point_tests.h>
#include <pcl/conversions.h>

#include <algorithm>
#include <type_traits>

#include "io/pcd_fields.h"
#include "io/ply_cloud.h"
#include "io/ply_header.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt {

using namespace internal;

namespace {

template <typename PointT>
void fill(pcl::PointCloud<PointT>& cloud, const std::vector<LidarPoint>& points) {
  cloud.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    PointT& point = cloud[i];
    point.getVector3fMap() = Eigen::Vector3f(points[i].x, points[i].y, points[i].z);
    if constexpr (std::is_same_v<PointT, pcl::PointXYZI>) point.intensity = points[i].intensity;
    cloud.is_dense = cloud.is_dense && pcl::isFinite(point);
  }
}

PcdField fieldOf(const std::filesystem::path& path, const pcl::PCLPointField& field) {
  using Type = pcl::PCLPointField;
  PcdField written{field.name, 4, 'F', std::max<std::uint64_t>(field.count, 1)};
  switch (field.datatype) {
    case Type::INT8:
    case Type::INT16:
    case Type::INT32:
      written.type = 'I';
      break;
    case Type::UINT8:
    case Type::UINT16:
    case Type::UINT32:
      written.type = 'U';
      break;
    case Type::FLOAT32:
    case Type::FLOAT64:
      break;
    default:
      throw Error(path.string(), "", "the field " + field.name + " is of a type that PCD files have not");
  }
  written.size = static_cast<std::uint64_t>(pcl::getFieldSize(field.datatype));
  return written;
}

}  // namespace

template <typename PointT>
pcl::PointCloud<PointT> readPointCloud(const std::filesystem::path& path, int bin_fields) {
  requireScanExtension(path);
  pcl::PointCloud<PointT> cloud;
  if (isBinScan(path)) {
    if constexpr (std::is_same_v<PointT, pcl::PointXYZL>) {
      throw Error(path.string(), "", "a KITTI scan holds no labels");
    } else {
      fill(cloud, readScanPoints(path, bin_fields).points);
      return cloud;
    }
  }
  const PcdCloud file = readCloudFile(path);
  fill(cloud, pointsOf(path, file));
  cloud.width = static_cast<std::uint32_t>(file.width);
  cloud.height = static_cast<std::uint32_t>(file.height);
  if constexpr (std::is_same_v<PointT, pcl::PointXYZL>) {
    const std::vector<std::uint32_t> labels = labelsOf(path, file);
    for (std::size_t i = 0; i < labels.size(); ++i) cloud[i].label = labels[i];
  }
  return cloud;
}

std::vector<std::string> pointCloudFields(const std::filesystem::path& path) {
  requireScanExtension(path);
  if (isBinScan(path)) return {"x", "y", "z", "intensity"};
  std::vector<std::string> names;
  const PcdHeader header = isPly(path) ? readPlyHeader(path).cloud : readPcdHeader(path);
  for (const PcdField& field : header.fields) names.push_back(field.name);
  return names;
}

void writeLabelledScan(const std::filesystem::path& path, const std::filesystem::path& scan_file,
                       const std::vector<StructuralLabel>& labels, int bin_fields) {
  requireScanExtension(scan_file);
  PcdCloud cloud = isBinScan(scan_file) ? cloudOf(readScanPoints(scan_file, bin_fields)) : readCloudFile(scan_file);
  if (labels.size() != cloud.points) {
    throw Error(scan_file.string(), "",
                std::to_string(labels.size()) + " labels, where it has " + std::to_string(cloud.points) + " points");
  }
  std::vector<std::uint32_t> values(labels.size());
  std::transform(labels.begin(), labels.end(), values.begin(),
                 [](StructuralLabel label) { return static_cast<std::uint32_t>(label); });
  cloud.set("label", 'U', values);
  writePcdCloud(path, cloud);
}

template <typename PointT>
void writePcd(const std::filesystem::path& path, const pcl::PointCloud<PointT>& cloud) {
  pcl::PCLPointCloud2 fields;
  pcl::toPCLPointCloud2(cloud, fields);
  writePcd(path, fields, cloud.sensor_origin_, cloud.sensor_orientation_);
}

void writePcd(const std::filesystem::path& path, const pcl::PCLPointCloud2& cloud, const Eigen::Vector4f& sensor_origin,
              const Eigen::Quaternionf& sensor_orientation) {
  PcdCloud file;
  file.width = cloud.width;
  file.height = cloud.height;
  file.points = file.width * file.height;
  const Eigen::Quaternionf& q = sensor_orientation;
  file.viewpoint = {sensor_origin.x(), sensor_origin.y(), sensor_origin.z(), q.w(), q.x(), q.y(), q.z()};
  for (const pcl::PCLPointField& field : cloud.fields) {
    file.columns.push_back({fieldOf(path, field), field.offset, cloud.point_step});
    if (field.offset + file.columns.back().field.bytes() > cloud.point_step) {
      throw Error(path.string(), "", "the field " + field.name + " does not lie within a point");
    }
  }
  if (cloud.point_step > 0 && cloud.data.size() / cloud.point_step < file.points) {
    throw Error(path.string(), "",
                std::to_string(cloud.data.size() / cloud.point_step) + " points are no cloud of " +
                    std::to_string(cloud.width) + " x " + std::to_string(cloud.height));
  }
  file.bytes.assign(cloud.data.begin(), cloud.data.end());
  writePcdCloud(path, file);
}

template pcl::PointCloud<pcl::PointXYZ> readPointCloud<pcl::PointXYZ>(const std::filesystem::path&, int);
template pcl::PointCloud<pcl::PointXYZI> readPointCloud<pcl::PointXYZI>(const std::filesystem::path&, int);
template pcl::PointCloud<pcl::PointXYZL> readPointCloud<pcl::PointXYZL>(const std::filesystem::path&, int);
template void writePcd<pcl::PointXYZ>(const std::filesystem::path&, const pcl::PointCloud<pcl::PointXYZ>&);
template void writePcd<pcl::PointXYZI>(const std::filesystem::path&, const pcl::PointCloud<pcl::PointXYZI>&);
template void writePcd<pcl::PointXYZL>(const std::filesystem::path&, const pcl::PointCloud<pcl::PointXYZL>&);

}  // namespace saw_ndt
