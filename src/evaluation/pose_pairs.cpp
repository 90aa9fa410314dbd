#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "saw_ndt/common/error.h"
#include "saw_ndt/evaluation/metrics.h"

namespace saw_ndt {

namespace {

// Stamps of about 1e9 s keep a quarter of a microsecond in a double.
constexpr double kStampRounding_s = 1e-6;

bool earlier(const StampedPose& a, const StampedPose& b) { return a.stamp_s < b.stamp_s; }

std::vector<StampedPose> sortedByStamp(const std::vector<StampedPose>& trajectory, const std::string& name) {
  if (trajectory.empty()) throw std::invalid_argument("the " + name + " trajectory holds no pose");
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    if (!std::isfinite(trajectory[i].stamp_s) || !trajectory[i].T_map_body.matrix().allFinite()) {
      throw std::invalid_argument("pose " + std::to_string(i) + " of the " + name + " trajectory is not finite");
    }
  }
  std::vector<StampedPose> sorted = trajectory;
  std::stable_sort(sorted.begin(), sorted.end(), earlier);
  return sorted;
}

/// Which of several poses of one stamp is meant cannot be told.
void requireOnePoseAStamp(const std::vector<StampedPose>& sorted, const std::string& name) {
  constexpr double kSamePlace_m = 0.01;
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    if (sorted[i].stamp_s > sorted[i - 1].stamp_s) continue;
    const double distance_m = (sorted[i].T_map_body.translation() - sorted[i - 1].T_map_body.translation()).norm();
    if (distance_m <= kSamePlace_m) continue;
    std::ostringstream reason;
    reason << "two poses of the " << name << " trajectory, " << distance_m << " m apart, have the same stamp ";
    reason.precision(12);
    reason << sorted[i].stamp_s << " s: which one is meant cannot be told";
    throw std::invalid_argument(reason.str());
  }
}

const StampedPose& nearestInTime(const std::vector<StampedPose>& sorted, const StampedPose& pose) {
  const auto after = std::lower_bound(sorted.begin(), sorted.end(), pose, earlier);
  if (after == sorted.begin()) return *after;
  const auto before = std::prev(after);
  if (after == sorted.end() || pose.stamp_s - before->stamp_s <= after->stamp_s - pose.stamp_s) return *before;
  return *after;
}

}  // namespace

std::vector<PosePair> matchTrajectories(const std::vector<StampedPose>& reference,
                                        const std::vector<StampedPose>& estimate, double skip_s) {
  checkOption(skip_s >= 0.0 && std::isfinite(skip_s), "skip_s", skip_s, "0 or greater");
  const std::vector<StampedPose> references = sortedByStamp(reference, "reference");
  const std::vector<StampedPose> estimates = sortedByStamp(estimate, "estimated");
  requireOnePoseAStamp(references, "reference");
  requireOnePoseAStamp(estimates, "estimated");
  const double first_evaluated_s = estimates.front().stamp_s + skip_s - kStampRounding_s;

  std::vector<PosePair> pairs;
  std::size_t late_enough = 0;
  for (const StampedPose& pose : estimates) {
    if (pose.stamp_s < first_evaluated_s) continue;
    ++late_enough;
    const StampedPose& nearest = nearestInTime(references, pose);
    if (std::abs(nearest.stamp_s - pose.stamp_s) > kStampTolerance_s + kStampRounding_s) continue;
    pairs.push_back({pose.stamp_s, nearest.T_map_body, pose.T_map_body});
  }
  if (pairs.empty()) {
    std::ostringstream reason;
    reason.precision(12);
    reason << "no pose to evaluate: ";
    if (late_enough == 0) {
      reason << "all " << estimates.size() << " estimated poses are within the first " << skip_s
             << " s, which are skipped";
    } else {
      reason << "no reference stamp (" << references.front().stamp_s << " to " << references.back().stamp_s
             << " s) is within " << kStampTolerance_s << " s of an estimated one (" << estimates.front().stamp_s
             << " to " << estimates.back().stamp_s << " s, the first " << skip_s << " s skipped)";
    }
    throw std::invalid_argument(reason.str());
  }
  return pairs;
}

}  // namespace saw_ndt
