#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <memory>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/common/scan_view.h"
#include "saw_ndt/map/voxel_weighting.h"
#include "saw_ndt/registration/source_points.h"
#include "saw_ndt/segmentation/scan_segmenter.h"

namespace saw_ndt {

/// Whether a moving LiDAR has skewed the scans ("rolling shutter"), and how it is told when it measured a point.
enum class MotionCompensation {
  OFF,         ///< points are as seen at the stamp of their scan, as in KITTI odometry's files
  FROM_TIMES,  ///< ScanView::times_s in any usual form: s, ms, us or ns, from the stamp, from the first point, absolute
  /// Seen from above, the LiDAR turns once in a period and looks along its x axis at the stamp:
  /// t = period * azimuth / (2 pi), azimuths from -pi to pi.
  FROM_AZIMUTH_COUNTERCLOCKWISE,
  FROM_AZIMUTH_CLOCKWISE,  ///< t = -period * azimuth / (2 pi)
};

/// "off", "times", "counterclockwise", "clockwise"
SAW_NDT_EXPORT const char* toString(MotionCompensation compensation);

/// When a scan was taken.
struct ScanTiming {
  double stamp_s = 0.0;
  double period_s = 0.1;  ///< how long a turn of the LiDAR takes
};

struct SAW_NDT_EXPORT ScanPreparationOptions {
  bool segment = true;               ///< label the points; without it every raw point is a source point
  SegmentationOptions segmentation;  ///< how
  double ground_ratio = 0.5;         ///< rho, the share of the ground points kept, 0 to 1; see GroundSampler
  ConfidenceOptions confidence;      ///< points of a label whose confidence is 0 are left out
  double source_voxel_size_m = 0.2;  ///< edge of the voxels that thin the points; 0 keeps every point
  Eigen::Isometry3d T_base_lidar = Eigen::Isometry3d::Identity();    ///< mounting of the LiDAR on the vehicle
  /// Points farther than this from the base, horizontally, are left out (m).
  double max_reach_m = std::numeric_limits<double>::infinity();
  MotionCompensation motion_compensation = MotionCompensation::OFF;  ///< where ScanPreparation::times_s() come from
  int threads = 0;                                                   ///< 0: all cores; the source does not depend on it

  /// Throws std::invalid_argument that names the field and its value.
  void check() const;
};

/// Makes of a scan the source points that are registered: segments it, selects points, brings them into the frame of
/// the vehicle's base, and thins them to one centroid for every voxel and label (Section III.C of the paper). Scratch
/// memory is kept from scan to scan. Not to be shared by threads that call it at the same time.
class SAW_NDT_EXPORT ScanPreparation {
 public:
  /// @throws std::invalid_argument where an option does not hold
  explicit ScanPreparation(const ScanPreparationOptions& options);
  ~ScanPreparation();
  ScanPreparation(ScanPreparation&& other) noexcept;
  ScanPreparation& operator=(ScanPreparation&& other) noexcept;

  /// The source of a scan, in the base's frame, valid until the next call.
  /// @param timing  for times_s()
  const SourcePoints& prepare(const ScanView& scan, const ScanTiming& timing = {});

  /// When each point of the last source was measured (s, from the stamp), of those thinned to one the mean; empty where
  /// motion_compensation is OFF, or the scan does not tell. The points themselves are as they were measured.
  const std::vector<float>& times_s() const;

  /// How long the last call took for the labels, and for selecting and thinning (ms).
  double segmentMilliseconds() const;
  double filterMilliseconds() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace saw_ndt
