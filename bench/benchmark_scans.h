#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <Eigen/Geometry>
#include <limits>
#include <string>
#include <vector>

#include "saw_ndt/drives/kitti_sequence.h"
#include "saw_ndt/localization/localization_method.h"
#include "saw_ndt/map/weighted_voxel_map.h"
#include "saw_ndt/registration/source_points.h"

namespace saw_ndt {

// What the benchmarks are run on: the first 70 scans at most of a drive. With the environment variable SAW_NDT_KITTI, a
// folder in KITTI's odometry layout, that is sequences/drive_0005 or else the first sequence there; otherwise a short
// drive through the residential scene, simulated once a process into a folder that goes with it. All of it is made at
// first use, which is to be in one thread, and stays for the process. Each function throws Error where there is
// neither a KITTI folder nor the simulator (Embree), or a file is damaged.

/// The drive.
const KittiSequence& benchmarkSequence();
/// The drive in words, such as "drive_0005 of /data/kitti" or "simulated residential drive".
const std::string& benchmarkSequenceDescription();
/// The reference pose of each scan of the drive, T_map_lidar.
const std::vector<Eigen::Isometry3d>& benchmarkPoses();
/// The scans that the map is made of: the even ones.
const std::vector<int>& benchmarkMapScans();
/// The scan that is benchmarked: the odd one in the middle of them, which the map does not hold.
int benchmarkScanNumber();
/// That scan (LiDAR frame).
const std::vector<LidarPoint>& benchmarkScan();
/// The same as PCL's registration takes it.
pcl::PointCloud<pcl::PointXYZ>::Ptr benchmarkScanPoints();
/// Its reference pose, T_map_lidar.
const Eigen::Isometry3d& benchmarkPose();
/// The map of benchmarkMapScans(), 1 m voxels, labelled.
const WeightedVoxelMap& benchmarkMap();
/// For benchmarkTarget(): all of it.
constexpr std::size_t kWholeTarget = std::numeric_limits<std::size_t>::max();
/// The points of benchmarkMapScans() in the map frame, the first `most` of them.
pcl::PointCloud<pcl::PointXYZ>::Ptr benchmarkTarget(std::size_t most);
/// What a Localizer of this method registers of a scan (LiDAR frame): labelled, ground thinned, 0.2 m source voxels.
SourcePoints benchmarkSource(const std::vector<LidarPoint>& scan, const LocalizationMethod& method);

}  // namespace saw_ndt
