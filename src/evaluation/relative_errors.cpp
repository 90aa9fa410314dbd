#include "saw_ndt/evaluation/relative_errors.h"

#include <algorithm>

#include "saw_ndt/common/geometry.h"

namespace saw_ndt {

namespace {

constexpr double kSegmentLengths_m[] = {100.0, 200.0, 300.0, 400.0, 500.0, 600.0, 700.0, 800.0};
constexpr std::size_t kStartStep = 10;

/// Length of the reference path from the first pose to each.
std::vector<double> pathLengths(const std::vector<PosePair>& pairs) {
  std::vector<double> lengths_m(pairs.size(), 0.0);
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    lengths_m[i] =
        lengths_m[i - 1] + (pairs[i].T_map_reference.translation() - pairs[i - 1].T_map_reference.translation()).norm();
  }
  return lengths_m;
}

}  // namespace

std::optional<KittiRelativeErrors> kittiRelativeErrors(const std::vector<PosePair>& pairs) {
  const std::vector<double> lengths_m = pathLengths(pairs);
  KittiRelativeErrors sum;
  for (std::size_t first = 0; first < pairs.size(); first += kStartStep) {
    for (const double segment_m : kSegmentLengths_m) {
      const auto end = std::upper_bound(lengths_m.begin(), lengths_m.end(), lengths_m[first] + segment_m);
      if (end == lengths_m.end()) break;
      const PosePair& a = pairs[first];
      const PosePair& b = pairs[static_cast<std::size_t>(end - lengths_m.begin())];
      const Eigen::Isometry3d T_reference = a.T_map_reference.inverse() * b.T_map_reference;
      const Eigen::Isometry3d T_estimate = a.T_map_estimate.inverse() * b.T_map_estimate;
      const Eigen::Isometry3d error = T_estimate.inverse() * T_reference;
      ++sum.segments;
      sum.translation_percent += 100.0 * error.translation().norm() / segment_m;
      sum.rotation_deg_per_m += degreesFromRadians(rotationAngle(error.linear())) / segment_m;
    }
  }
  if (sum.segments == 0) return std::nullopt;
  sum.translation_percent /= static_cast<double>(sum.segments);
  sum.rotation_deg_per_m /= static_cast<double>(sum.segments);
  return sum;
}

}  // namespace saw_ndt
