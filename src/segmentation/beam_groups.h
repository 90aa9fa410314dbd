#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "saw_ndt/common/scan_view.h"

namespace saw_ndt::internal {

/// A sensor has no more beams than these,
constexpr std::size_t kMostBeams = 1024;
/// none as steep as this, which is what lies straight above or below it (degrees),
constexpr double kSteepestBeam_deg = 89.9;
/// and sees no return as far away (m).
constexpr float kFarthestReturn_m = 1.0e4F;

/// Points of a scan that one beam may have measured.
struct BeamGroup {
  int number = 0;              ///< of the ring, row or run
  double elevation_deg = 0.0;  ///< median
  double spread_deg = 0.0;     ///< median distance from that
  double step_deg = 0.0;       ///< median azimuth from one point to the next; 0 where there are too few
  std::size_t points = 0;
};

/// Groups that hold enough points, in order of their numbers.
struct BeamGroups {
  std::string evidence;  ///< what they were made by
  std::vector<BeamGroup> groups;
  int count = 0;          ///< of all groups, those without points among them
  bool numbered = false;  ///< the sensor numbers them: one a beam, be it without points

  /// Whether they are beams: several of them, apart by more than they are wide.
  bool areBeams() const;
  /// Whether elevations rise with numbers, or fall, but for a few that noise exchanged.
  bool areInOrder() const;
};

/// Groups the points of a scan by all means that it offers, best first.
std::vector<BeamGroups> beamGroupsOf(const ScanView& scan);

}  // namespace saw_ndt::internal
