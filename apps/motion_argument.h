#pragma once

#include <iostream>
#include <optional>
#include <string>

#include "app_options.h"
#include "saw_ndt/drives/motion_trial.h"

namespace saw_ndt {

/// The option -motion-compensation of every app that puts scans of a moving LiDAR together.
class MotionArgument {
 public:
  void addTo(AppOptions& app) {
    app.addChoice("motion-compensation", &text_, {"auto", "off", "times", "counterclockwise", "clockwise"},
                  "whether scans are skewed by the motion of the LiDAR, to be taken out, and what tells when a point "
                  "was measured: its time field, or its azimuth, by how the LiDAR turns seen from above and with the "
                  "stamp where it looks along x. off for scans that are compensated already, such as those of KITTI "
                  "odometry; auto tries out which of them moving scans agree best with, and is off where that is in "
                  "doubt");
  }
  /// Nothing for auto.
  std::optional<MotionCompensation> value() const {
    for (const MotionCompensation value :
         {MotionCompensation::OFF, MotionCompensation::FROM_TIMES, MotionCompensation::FROM_AZIMUTH_COUNTERCLOCKWISE,
          MotionCompensation::FROM_AZIMUTH_CLOCKWISE}) {
      if (text_ == toString(value)) return value;
    }
    return std::nullopt;
  }

 private:
  std::string text_ = "auto";
};

/// Prints on stderr what auto decided.
inline void tellDecision(const AppOptions& app, const MotionTrial& trial) {
  std::cerr << app.name() << ": -motion-compensation auto: " << toString(trial.compensation) << ": " << trial.reason
            << '\n';
}

}  // namespace saw_ndt
