#pragma once

#include <pcl/PCLPointCloud2.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <vector>

#include "saw_ndt/common/export.h"

namespace saw_ndt {

/// Reads a point cloud in metres: a KITTI scan where the name ends in .bin, a PCD file where it ends in .pcd.
///
/// PointT is pcl::PointXYZ, PointXYZI or PointXYZL. An intensity that the file has not is 0; labels must be there.
/// Throws Error where the file is of neither kind, missing, damaged, or lacks a field.
template <typename PointT>
SAW_NDT_EXPORT pcl::PointCloud<PointT> readPointCloud(const std::filesystem::path& path);

/// The names of the fields of such a file, such as x y z label; of a KITTI scan x y z intensity.
SAW_NDT_EXPORT std::vector<std::string> pointCloudFields(const std::filesystem::path& path);

/// Writes a compressed binary PCD file, whole or not at all. Throws Error, also for a cloud without points, which the
/// format cannot hold.
template <typename PointT>
SAW_NDT_EXPORT void writePcd(const std::filesystem::path& path, const pcl::PointCloud<PointT>& cloud);

/// The same for points of any type, as pcl::toPCLPointCloud2() gives them.
SAW_NDT_EXPORT void writePcd(const std::filesystem::path& path, const pcl::PCLPointCloud2& cloud,
                             const Eigen::Vector4f& sensor_origin = Eigen::Vector4f::Zero(),
                             const Eigen::Quaternionf& sensor_orientation = Eigen::Quaternionf::Identity());

}  // namespace saw_ndt
