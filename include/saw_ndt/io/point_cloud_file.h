#pragma once

#include <pcl/PCLPointCloud2.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/common/labels.h"
#include "saw_ndt/io/scan_file.h"

namespace saw_ndt {

/// Reads a point cloud in metres, as readScanPoints() does, of fields of any number type.
///
/// PointT is pcl::PointXYZ, PointXYZI or PointXYZL. An intensity that the file has not is 0; labels must be there.
/// Throws Error where the file is of no such kind, missing, damaged, or lacks a field.
/// @param bin_fields  see readScanPoints()
template <typename PointT>
SAW_NDT_EXPORT pcl::PointCloud<PointT> readPointCloud(const std::filesystem::path& path, int bin_fields = 0);

/// Writes the points of a scan's file with labels as a compressed binary PCD file, whole or not at all: all fields that
/// a PCD or PLY file has but padding and an older label, its rows and its viewpoint; x y z intensity and ring and time,
/// where they are known, of a .bin file; and a `label` (uint32). Throws Error, also where there is not a label for each
/// point.
/// @param bin_fields  see readScanPoints()
SAW_NDT_EXPORT void writeLabelledScan(const std::filesystem::path& path, const std::filesystem::path& scan_file,
                                      const std::vector<StructuralLabel>& labels, int bin_fields = 0);

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
