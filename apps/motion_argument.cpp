#include "motion_argument.h"

#include <algorithm>

namespace saw_ndt {
namespace {

bool firstHasTimes(ScanSource& scans) {
  RecordedScan scan;
  return scans.next(scan) && viewOf(scan).times_s.known();
}

}  // namespace

void MotionArgument::addTo(AppOptions& app) {
  app.addChoice("motion-compensation", &text_, {"auto", "off", "times", "counterclockwise", "clockwise"},
                "whether the motion of the LiDAR during a turn is to be taken out of the scans, and what tells when a "
                "point was measured: `times`, its time field; counterclockwise or clockwise, its azimuth, by how the "
                "LiDAR turns seen from above, where it looks along x at the stamp. off: scans are compensated already, "
                "as those of KITTI odometry. auto: a trial with the first moving scans finds what they agree best "
                "with; off where that is in doubt");
}

std::optional<MotionCompensation> MotionArgument::stated() const {
  for (const MotionCompensation value :
       {MotionCompensation::OFF, MotionCompensation::FROM_TIMES, MotionCompensation::FROM_AZIMUTH_COUNTERCLOCKWISE,
        MotionCompensation::FROM_AZIMUTH_CLOCKWISE}) {
    if (text_ == toString(value)) return value;
  }
  return std::nullopt;
}

MotionTrial MotionArgument::decide(const AppOptions& app, const Recording& recording, const std::vector<int>& selected,
                                   const std::function<MotionTrial()>& trial) const {
  const std::optional<MotionCompensation> value = stated();
  if (!value && recording.isRaw()) return {MotionCompensation::FROM_TIMES, "scans are as the sensor sent them"};
  if (!value) return trial();
  if (*value == MotionCompensation::OFF && firstHasTimes(*recording.scans(selected))) {
    const MotionTrial tried = trial();
    if (tried.compensation != MotionCompensation::OFF) {
      warn(app, "-motion-compensation off, but scans look skewed by the motion of the LiDAR: " + tried.reason);
    }
  }
  return {*value, "as stated"};
}

MotionTrial MotionArgument::decideLive(const std::vector<ScanPoints>& first) const {
  if (const std::optional<MotionCompensation> value = stated()) return {*value, "as stated"};
  const bool have_times =
      std::any_of(first.begin(), first.end(), [](const ScanPoints& scan) { return !scan.times_s.empty(); });
  if (have_times) return {MotionCompensation::FROM_TIMES, "scans are as the sensor sent them"};
  return {MotionCompensation::OFF, "scans come from a live source, and their points have no times"};
}

}  // namespace saw_ndt
