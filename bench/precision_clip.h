#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <string>
#include <vector>

#include "saw_ndt/drives/kitti_sequence.h"
#include "saw_ndt/localization/localizer.h"

namespace saw_ndt {

/// A scan, labelled as a whole.
struct LabelledScan {
  std::vector<LidarPoint> points;
  std::vector<StructuralLabel> labels;
  Eigen::Isometry3d T_map_lidar;  ///< reference
};

/// Every other point of a scan, from the first or the second on.
LabelledScan halfOf(const LabelledScan& scan, std::size_t first);

/// The scans of a drive in a map frame that is moved against the reference's, so that voxels cut the scene elsewhere.
/// @param frame  0: the reference's own; each other number another turn about the vertical axis and another offset
std::vector<LabelledScan> labelledScans(const KittiSequence& sequence, int frame, int threads);

/// Finds the pose of a scan from a start.
using ScanAligner = std::function<Eigen::Isometry3d(const LabelledScan& scan, const Eigen::Isometry3d& T_map_start)>;

/// The aligner of a method to the map of those of the scans that `picks` says, at their reference poses.
/// @param method  one of LocalizationMethod::names() or kPclNdtMethod
ScanAligner alignerToMapOf(const std::vector<LabelledScan>& scans, const std::function<bool(std::size_t)>& picks,
                           const std::string& method, int threads);

/// What two halves of a scan, aligned with maps of different scans, differ by, over the root of two: the random error
/// of half a scan in half a map.
struct HalvesError {
  double position_m = 0.0;
  double yaw_deg = 0.0;
};

/// For every scan with an odd number: its halves against the maps of every fourth scan from 0 and from 2.
/// @param displacement_m  how far to either side of the reference poses the halves start; 0 flatters what stays where
/// it
///                        started
std::vector<HalvesError> halvesErrors(const std::vector<LabelledScan>& scans, const std::string& method,
                                      double displacement_m, int threads, const std::function<void()>& scan_done);

/// Mean standard deviation (m) across the planar voxels of 0.5 m of a map of the scans with odd numbers, at the poses
/// that a method finds in the map of the others, or at their reference poses where the method is empty. Voxels of fewer
/// than 20 points are left out.
double mapThickness(const std::vector<LabelledScan>& scans, const std::string& method, int threads);

}  // namespace saw_ndt
