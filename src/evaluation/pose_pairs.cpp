#include "saw_ndt/evaluation/pose_pairs.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>

#include "common/pose_interpolation.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt {

using namespace internal;

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

std::size_t nearestInTime(const std::vector<StampedPose>& sorted, const StampedPose& pose) {
  const auto after = std::lower_bound(sorted.begin(), sorted.end(), pose, earlier);
  const auto place = static_cast<std::size_t>(after - sorted.begin());
  if (after == sorted.begin()) return place;
  const bool nearer_before =
      after == sorted.end() || pose.stamp_s - std::prev(after)->stamp_s <= after->stamp_s - pose.stamp_s;
  return nearer_before ? place - 1 : place;
}

/// Where reference and estimate are close in time: their places in the two sorted trajectories.
struct Match {
  std::size_t reference, estimate;
};

std::vector<Match> nearestMatches(const std::vector<StampedPose>& references, const std::vector<StampedPose>& estimates,
                                  double max_difference_s) {
  const bool by_reference = references.size() < estimates.size();
  const std::vector<StampedPose>& few = by_reference ? references : estimates;
  const std::vector<StampedPose>& many = by_reference ? estimates : references;
  std::vector<Match> matches;
  for (std::size_t i = 0; i < few.size(); ++i) {
    const std::size_t nearest = nearestInTime(many, few[i]);
    if (std::abs(many[nearest].stamp_s - few[i].stamp_s) > max_difference_s + kStampRounding_s) continue;
    matches.push_back(by_reference ? Match{i, nearest} : Match{nearest, i});
  }
  return matches;
}

/// The reference at a moment, to within the rounding of stamps also at its ends.
std::optional<Eigen::Isometry3d> referenceAt(const std::vector<StampedPose>& references, double stamp_s,
                                             double longest_gap_s) {
  const double first_s = references.front().stamp_s, last_s = references.back().stamp_s;
  if (stamp_s < first_s - kStampRounding_s || stamp_s > last_s + kStampRounding_s) return std::nullopt;
  return poseAt(references, std::clamp(stamp_s, first_s, last_s), longest_gap_s + kStampRounding_s);
}

std::string whyNone(const PairingOptions& options, const std::vector<StampedPose>& references,
                    const std::vector<StampedPose>& estimates, std::size_t late_enough) {
  std::ostringstream reason;
  reason.precision(12);
  reason << "no pose to evaluate: ";
  if (late_enough == 0) {
    reason << "all " << estimates.size() << " estimated poses are within the first " << options.skip_s
           << " s, which are skipped";
    return reason.str();
  }
  std::ostringstream stamps;
  stamps.precision(12);
  stamps << " (" << references.front().stamp_s << " to " << references.back().stamp_s << " s) ";
  if (options.interpolate) {
    reason << "no two reference stamps" << stamps.str() << "at most " << options.longest_gap_s
           << " s apart are around an estimated one (";
  } else {
    reason << "no reference stamp" << stamps.str() << "is within " << options.max_difference_s
           << " s of an estimated one (";
  }
  reason << estimates.front().stamp_s << " to " << estimates.back().stamp_s << " s, ";
  if (options.offset_s != 0.0) reason << "the offset of " << options.offset_s << " s added, ";
  reason << "the first " << options.skip_s << " s skipped)";
  return reason.str();
}

}  // namespace

void PairingOptions::check() const {
  checkOption(skip_s >= 0.0 && std::isfinite(skip_s), "skip_s", skip_s, "0 or greater");
  checkOption(max_difference_s >= 0.0 && std::isfinite(max_difference_s), "max_difference_s", max_difference_s,
              "0 or greater");
  checkOption(std::isfinite(offset_s), "offset_s", offset_s, "a finite number");
  checkOption(longest_gap_s > 0.0 && std::isfinite(longest_gap_s), "longest_gap_s", longest_gap_s, "positive");
}

PairedTrajectories pairTrajectories(const std::vector<StampedPose>& reference, const std::vector<StampedPose>& estimate,
                                    const PairingOptions& options) {
  options.check();
  const std::vector<StampedPose> references = sortedByStamp(reference, "reference");
  std::vector<StampedPose> estimates = sortedByStamp(estimate, "estimated");
  requireOnePoseAStamp(references, "reference");
  requireOnePoseAStamp(estimates, "estimated");
  for (StampedPose& pose : estimates) pose.stamp_s += options.offset_s;

  const double first_evaluated_s = estimates.front().stamp_s + options.skip_s - kStampRounding_s;
  const auto isEvaluated = [&](const StampedPose& pose) { return pose.stamp_s >= first_evaluated_s; };
  PairedTrajectories result;
  result.reference_poses = references.size();
  result.estimate_poses = static_cast<std::size_t>(std::count_if(estimates.begin(), estimates.end(), isEvaluated));
  if (options.interpolate) {
    for (const StampedPose& pose : estimates) {
      if (!isEvaluated(pose)) continue;
      const auto T_map_reference = referenceAt(references, pose.stamp_s, options.longest_gap_s);
      if (T_map_reference) result.pairs.push_back({pose.stamp_s, *T_map_reference, pose.T_map_body});
    }
    result.paired_estimates = result.pairs.size();
  } else {
    std::optional<std::size_t> last;
    for (const Match& match : nearestMatches(references, estimates, options.max_difference_s)) {
      const StampedPose& pose = estimates[match.estimate];
      if (!isEvaluated(pose)) continue;
      result.pairs.push_back({pose.stamp_s, references[match.reference].T_map_body, pose.T_map_body});
      if (last != match.estimate) ++result.paired_estimates;
      last = match.estimate;
    }
  }
  if (result.pairs.empty()) {
    throw std::invalid_argument(whyNone(options, references, estimates, result.estimate_poses));
  }
  return result;
}

std::vector<PosePair> matchTrajectories(const std::vector<StampedPose>& reference,
                                        const std::vector<StampedPose>& estimate, double skip_s) {
  PairingOptions options;
  options.skip_s = skip_s;
  return pairTrajectories(reference, estimate, options).pairs;
}

}  // namespace saw_ndt
