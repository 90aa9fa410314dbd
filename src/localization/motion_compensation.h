#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/common/scan_view.h"
#include "saw_ndt/localization/scan_preparation.h"
#include "saw_ndt/registration/source_points.h"

namespace saw_ndt::internal {

/// The motion of a body that moves and turns evenly, in its own frame.
struct BodyMotion {
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
  Eigen::Vector3d turn_rate_radps = Eigen::Vector3d::Zero();
};

/// The motion of a body during a scan.
struct ScanMotion {
  BodyMotion before;  ///< until the stamp
  BodyMotion after;   ///< from the stamp on

  static ScanMotion even(const BodyMotion& motion) { return {motion, motion}; }
};

/// What of a motion of a vehicle goes on: that in the plane that it stands on. What is across it are shocks of the
/// road.
BodyMotion planarPart(const BodyMotion& motion);

/// The even motion that leads from one pose to another.
/// @param T_before_now  pose of the body in its frame before
/// @param duration_s    that it took, other than 0
SAW_NDT_EXPORT BodyMotion motionBetween(const Eigen::Isometry3d& T_before_now, double duration_s);

/// How far two motions carry a point kShiftArm_m away from each other (m) in a time before or after the stamp.
SAW_NDT_EXPORT double shiftBetween(const ScanMotion& a, const ScanMotion& b, double duration_s);
constexpr double kShiftArm_m = 20.0;

/// How the times of a scan's points are read.
struct ScanClock {
  double zero = 0.0;    ///< the time of the stamp, in the numbers of the scan
  double unit_s = 1.0;  ///< of these numbers

  /// A time from the stamp (s).
  float operator()(double number) const { return static_cast<float>((number - zero) * unit_s); }
};

/// Finds out how ScanView::times_s of a scan are to be read. The unit follows from how long the scan lasts, 0.01 to
/// 1.5 s: a second, or the thousandth, millionth or billionth of it. Numbers on both sides of 0, or from 0 on, are
/// taken from the stamp; others within 1.5 s of it are absolute; of any others the first is at the stamp. Nothing where
/// there are none or they last otherwise.
SAW_NDT_EXPORT std::optional<ScanClock> clockOf(const ScanView& scan, double stamp_s);

/// When points were measured by a LiDAR that turns once in a period and looks along x at the stamp (s, from there):
/// t = +-period_s * atan2(y, x) / (2 pi).
/// @param T_base_lidar      where the LiDAR is in the frame of the points
/// @param counterclockwise  how it turns, seen from above
SAW_NDT_EXPORT void timesFromAzimuth(const SourcePoints& points, const Eigen::Isometry3d& T_base_lidar,
                                     bool counterclockwise, double period_s, std::vector<float>& times_s);

/// Points as a moving body sees them at the stamp, each measured at a time of its own:
/// q = exp(t [w v]) p = p + t u + (1 - cos |w|t) / |w|^2 w x u + (|w|t - sin |w|t) / |w|^3 w x (w x u), u = v + w x p.
/// @param points   in the frame of the body; labels are not looked at
/// @param times_s  from the stamp, one a point
/// @param moved    its coordinates are set
SAW_NDT_EXPORT void compensate(const SourcePoints& points, const std::vector<float>& times_s, const ScanMotion& motion,
                               SourcePoints& moved);

/// The same of the points of a scan in their order, with times by ScanPreparationOptions::motion_compensation. Points
/// that are no returns or have no time stay as they are.
/// @param motion  of the LiDAR
/// @return false where the scan does not tell times; `moved` is then that of the scan as it is
SAW_NDT_EXPORT bool compensateScan(const ScanView& scan, MotionCompensation times, const ScanTiming& timing,
                                   const ScanMotion& motion, std::vector<LidarPoint>& moved);

/// How long a turn of the LiDAR takes, from the stamps of scans: the median of their last distances. A tenth of a
/// second until there are any.
class SAW_NDT_EXPORT ScanPeriod {
 public:
  /// @param known_s  0: not known
  explicit ScanPeriod(double known_s = 0.0) : known_s_(known_s) {}

  void add(double stamp_s);
  double seconds() const;

 private:
  static constexpr std::size_t kMost = 15;

  double known_s_;
  std::optional<double> last_stamp_s_;
  std::array<double, kMost> distances_s_{};
  std::size_t count_ = 0;
};

/// The source of a scan by the motion of the vehicle during it. Keeps its memory from scan to scan.
class SAW_NDT_EXPORT MovingSource {
 public:
  /// @param source   as it was measured, in the base's frame; both must live until the next scan
  /// @param times_s  ScanPreparation::times_s(); empty: they are not known
  void take(const SourcePoints& source, const std::vector<float>& times_s);

  /// Whether the points have times that differ.
  bool hasTimes() const { return reach_s_ > 0.0; }
  /// How far from the stamp the points were measured at most (s).
  double reach_s() const { return reach_s_; }
  /// What take() was given.
  const SourcePoints& measured() const { return *source_; }
  const std::vector<float>& times_s() const { return *times_s_; }

  /// The source as seen at the stamp, valid until the next call: that of take() itself, bit for bit, where no point
  /// moves by a centimetre, as if the vehicle stood.
  const SourcePoints& compensatedBy(const ScanMotion& motion);

 private:
  const SourcePoints* source_ = nullptr;
  const std::vector<float>* times_s_ = nullptr;
  SourcePoints moved_;
  double reach_s_ = 0.0;
};

}  // namespace saw_ndt::internal
