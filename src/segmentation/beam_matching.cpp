#include "segmentation/beam_matching.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace saw_ndt::internal {

float BeamMatching::match(const std::vector<float>& elevations_deg, const std::vector<float>& spreads_deg,
                          const SensorModel& sensor) {
  const std::size_t groups = elevations_deg.size();
  const auto rows = static_cast<std::size_t>(sensor.rows());
  const float unreachable = std::numeric_limits<float>::infinity();
  if (groups == 0 || groups > rows) return unreachable;

  // Rows rise with groups: the cheapest such assignment, by dynamic programming over (group, row).
  costs_.assign(rows + 1, 0.0F);  // costs_[row]: the cheapest assignment of the groups so far to rows before `row`
  taken_.assign(groups * rows, 0);
  for (std::size_t group = 0; group < groups; ++group) {
    float before = costs_[0];
    costs_[0] = unreachable;
    for (std::size_t row = 0; row < rows; ++row) {
      const auto beam = static_cast<float>(sensor.elevations_deg[row]);
      const float spread = spreads_deg.empty() ? 0.0F : spreads_deg[group];
      const float here = before + std::abs(elevations_deg[group] - beam) + spread;
      before = costs_[row + 1];
      taken_[group * rows + row] = here < costs_[row] ? 1 : 0;
      costs_[row + 1] = std::min(here, costs_[row]);
    }
  }

  rows_.resize(groups);
  std::size_t row = rows;
  for (std::size_t group = groups; group-- > 0;) {
    do {
      --row;
    } while (taken_[group * rows + row] == 0);
    rows_[group] = static_cast<std::int16_t>(row);
  }
  return costs_[rows] / static_cast<float>(groups);
}

}  // namespace saw_ndt::internal
