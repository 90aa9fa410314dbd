#pragma once

#include <cstdint>
#include <vector>

#include "saw_ndt/common/sensor_model.h"

namespace saw_ndt::internal {

/// Tells which beams of a sensor groups of points belong to, by their elevations. Memory is kept.
class BeamMatching {
 public:
  /// Assigns groups that are listed from the top down to beams, each to another one, at the least cost. That of a group
  /// is how far it is from its beam and its spread.
  /// @param spreads_deg  one a group, or none
  /// @return the mean cost in degrees, infinite where there are more groups than beams
  float match(const std::vector<float>& elevations_deg, const std::vector<float>& spreads_deg,
              const SensorModel& sensor);

  /// The row of each group after a match of a finite cost.
  const std::vector<std::int16_t>& rows() const { return rows_; }

 private:
  std::vector<std::int16_t> rows_;
  std::vector<float> costs_;
  std::vector<std::uint8_t> taken_;
};

}  // namespace saw_ndt::internal
