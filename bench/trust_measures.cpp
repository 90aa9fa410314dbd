#include "trust_measures.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "evaluation/statistics.h"
#include "registration/pose_lengths.h"

namespace saw_ndt {
namespace {

constexpr double kGreatestDistance_m = 0.5, kGreatestAngle_deg = 2.0;
constexpr double kChiSquared95 = 12.592;  // of six degrees of freedom
constexpr double kFreeSigmas = 3.0;
constexpr double kRecoveryTime_s = 5.0, kScansPerSecond = 10.0;

bool isRight(const PoseDifference& difference) {
  return difference.distance_m() <= kGreatestDistance_m && difference.angle_deg() <= kGreatestAngle_deg;
}

/// Whether the alignment came to a pose at all.
bool isAligned(const AlignmentResult& alignment) {
  return alignment.status == AlignmentStatus::CONVERGED || alignment.status == AlignmentStatus::ITERATION_LIMIT ||
         alignment.status == AlignmentStatus::UNDETERMINED;
}

std::string percentOf(int part, int whole) {
  if (whole == 0) return "";
  char text[40];
  std::snprintf(text, sizeof text, "%.1f", 100.0 * part / whole);
  return text;
}

std::string number(double value, const char* format) {
  char text[40];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

/// "1.000 2.000 3.000 m, 0.100 0.200 0.300 deg"
std::string inWords(const Vector6d& along_axes) {
  char text[120];
  const Eigen::Vector3d deg = along_axes.tail<3>() * degreesFromRadians(1.0);
  std::snprintf(text, sizeof text, "%.3f %.3f %.3f m, %.3f %.3f %.3f deg", along_axes[0], along_axes[1], along_axes[2],
                deg[0], deg[1], deg[2]);
  return text;
}

std::string inWords(int scan, const LocalizationResult& result, const PoseDifference& difference) {
  const Eigen::Matrix3d R_map_base = result.T_map_base.linear();
  Vector6d in_base;
  in_base << R_map_base.transpose() * difference.e.head<3>(), R_map_base.transpose() * difference.e.tail<3>();
  const std::string free = freeAxes(result.free_directions, R_map_base);
  return "scan " + std::to_string(scan) + ": error " + inWords(in_base) + "; sigma " +
         inWords(standardDeviations(result.covariance, R_map_base)) + "; free: " + (free.empty() ? "nothing" : free);
}

}  // namespace

bool isLost(const LocalizationResult& result) { return result.track.isLost(); }

bool misleads(const PoseDifference& difference, const Matrix6d& covariance, const PoseDirections& free_directions) {
  if (isRight(difference)) return false;
  const Matrix6d onto_free = internal::projectorOnto(free_directions);
  const Matrix6d free_covariance = onto_free * covariance * onto_free.transpose();
  const Vector6d told = kFreeSigmas * free_covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Vector6d beyond = (difference.e.cwiseAbs() - told).cwiseMax(0.0);
  return !isRight({beyond});
}

double normalizedSquaredError(const PoseDifference& difference, const Matrix6d& covariance) {
  const Eigen::LDLT<Matrix6d> decomposition(covariance);
  if (decomposition.info() != Eigen::Success || !(decomposition.vectorD().minCoeff() > 0.0)) return -1.0;
  return difference.e.dot(decomposition.solve(difference.e));
}

void Consistency::add(double normalized_squared_error) {
  if (!(normalized_squared_error >= 0.0)) return;
  sum += normalized_squared_error / 6.0;
  ++count;
  if (normalized_squared_error <= kChiSquared95) ++inside;
}

void Consistency::add(const Consistency& other) {
  sum += other.sum;
  count += other.count;
  inside += other.inside;
}

void TrustCounts::add(const TrustCounts& other) {
  runs += other.runs;
  failed_runs += other.failed_runs;
  scans += other.scans;
  accepted += other.accepted;
  accepted_of_nothing += other.accepted_of_nothing;
  rejected_though_right += other.rejected_though_right;
  wrong_accepted += other.wrong_accepted;
  worst_m = std::max(worst_m, other.worst_m);
  worst_deg = std::max(worst_deg, other.worst_deg);
  astray_before_runs += other.astray_before_runs;
  astray_runs += other.astray_runs;
  scans_until_lost.insert(scans_until_lost.end(), other.scans_until_lost.begin(), other.scans_until_lost.end());
  wrongly_lost_runs += other.wrongly_lost_runs;
  ended_faults += other.ended_faults;
  recovered_runs += other.recovered_runs;
  of_accepted.add(other.of_accepted);
  of_rejected.add(other.of_rejected);
}

void RunJudge::see(const LocalizationResult& result) {
  const int scan_number = static_cast<int>(next_);
  const PlayedScan& scan = run_.scans.at(next_++);
  const PoseDifference published{poseDifference(scan.T_map_lidar, result.T_map_base)};
  const bool wrong = !run_.place_in_map || misleads(published, result.covariance, result.free_directions);
  last_in_words_ = std::string(toString(result.acceptance)) + ", " + toString(result.track.status) + "; overlap " +
                   number(result.alignment.overlap, "%.2f") + "; " + inWords(scan_number, result, published) +
                   (wrong ? "; wrong" : "");
  if (run_.fault_begin > static_cast<std::size_t>(scan_number)) {
    counts_.astray_before_runs = wrong ? 1 : 0;
    return;
  }
  ++counts_.scans;
  if (result.accepted()) {
    ++counts_.accepted;
    if (scan.shows_nothing) ++counts_.accepted_of_nothing;
    if (wrong) ++counts_.wrong_accepted;
    if (wrong && first_wrong_accepted_.empty()) first_wrong_accepted_ = inWords(scan_number, result, published);
    if (run_.place_in_map) {
      counts_.worst_m = std::max(counts_.worst_m, published.distance_m());
      counts_.worst_deg = std::max(counts_.worst_deg, published.angle_deg());
    }
  } else if (run_.place_in_map && !scan.shows_nothing && isAligned(result.alignment) &&
             isRight({poseDifference(scan.T_map_lidar, result.alignment.T_map_source)})) {
    ++counts_.rejected_though_right;
  }
  if (run_.place_in_map) {
    Consistency& consistency = result.accepted() ? counts_.of_accepted : counts_.of_rejected;
    consistency.add(normalizedSquaredError(published, result.covariance));
  }
  const std::size_t fault_end = std::max(run_.fault_begin, run_.fault_end);
  const auto after_fault = static_cast<double>(scan_number) - static_cast<double>(fault_end);
  if (run_.place_in_map && after_fault >= 0.0) {
    counts_.ended_faults = 1;
    recovered_ = recovered_ || (result.accepted() && !wrong && after_fault < kRecoveryTime_s * kScansPerSecond);
  }
  if (was_lost_) return;
  if (!wrong) {
    wrong_since_ = -1;
  } else if (wrong_since_ < 0) {
    wrong_since_ = scan_number;
  }
  if (!isLost(result)) return;
  was_lost_ = true;
  if (wrong) {
    counts_.astray_runs = 1;
    counts_.scans_until_lost.push_back(scan_number - wrong_since_);
  } else {
    counts_.wrongly_lost_runs = 1;
  }
}

TrustCounts RunJudge::finish() {
  counts_.recovered_runs = recovered_ ? 1 : 0;
  if (!was_lost_ && wrong_since_ >= 0) counts_.astray_runs = 1;
  return counts_;
}

std::string trustTableHead(const std::vector<std::string>& names) {
  std::vector<std::string> columns = names;
  for (const char* name :
       {"runs", "scans", "accepted %", "rejected though right", "wrong accepted", "worst accepted (m / deg)",
        "accepted of nothing", "astray before", "astray", "told lost", "scans until lost (median)", "wrongly lost",
        "recovered in 5 s (%)", "NEES / 6", "inside 95 % (%)", "rejected inside 95 % (%)", "failed"}) {
    columns.emplace_back(name);
  }
  std::string head = "|", rule = "|";
  for (const std::string& column : columns) {
    head += " " + column + " |";
    rule += "---|";
  }
  return head + "\n" + rule + "\n";
}

std::string trustTableRow(const std::vector<std::string>& names, const TrustCounts& counts) {
  const auto meanOf = [](const Consistency& of) { return of.count > 0 ? number(of.sum / of.count, "%.3g") : ""; };
  std::vector<std::string> cells = names;
  cells.push_back(std::to_string(counts.runs));
  cells.push_back(std::to_string(counts.scans));
  cells.push_back(percentOf(counts.accepted, counts.scans));
  cells.push_back(std::to_string(counts.rejected_though_right));
  cells.push_back(std::to_string(counts.wrong_accepted));
  const bool has_worst = counts.worst_m > 0.0;
  cells.push_back(has_worst ? number(counts.worst_m, "%.3f / ") + number(counts.worst_deg, "%.2f") : "");
  cells.push_back(std::to_string(counts.accepted_of_nothing));
  cells.push_back(std::to_string(counts.astray_before_runs));
  cells.push_back(std::to_string(counts.astray_runs));
  cells.push_back(std::to_string(counts.scans_until_lost.size()));
  cells.push_back(counts.scans_until_lost.empty() ? "" : number(internal::median(counts.scans_until_lost), "%.1f"));
  cells.push_back(std::to_string(counts.wrongly_lost_runs));
  cells.push_back(percentOf(counts.recovered_runs, counts.ended_faults));
  cells.push_back(meanOf(counts.of_accepted));
  cells.push_back(percentOf(counts.of_accepted.inside, counts.of_accepted.count));
  cells.push_back(percentOf(counts.of_rejected.inside, counts.of_rejected.count));
  cells.push_back(std::to_string(counts.failed_runs));
  std::string row = "|";
  for (const std::string& cell : cells) row += " " + cell + " |";
  return row + "\n";
}

}  // namespace saw_ndt
