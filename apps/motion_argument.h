#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app_options.h"
#include "saw_ndt/drives/motion_trial.h"
#include "saw_ndt/drives/recording.h"

namespace saw_ndt {

/// The option -motion-compensation of every app that puts scans of a moving LiDAR together.
class MotionArgument {
 public:
  void addTo(AppOptions& app);

  /// What the command line states or, for auto, what a trial finds; times where a recording is known to be raw. Where
  /// compensation is switched off and scans have times, the trial is made all the same, and a warning says if they look
  /// skewed.
  MotionTrial decide(const AppOptions& app, const Recording& recording, const std::vector<int>& selected,
                     const std::function<MotionTrial()>& trial) const;
  /// The same for a source that cannot be read twice: for auto, by the times of its first scans' points where they have
  /// such, for a live sensor's scans are not compensated elsewhere.
  MotionTrial decideLive(const std::vector<ScanPoints>& first) const;

 private:
  std::optional<MotionCompensation> stated() const;

  std::string text_ = "auto";
};

}  // namespace saw_ndt
