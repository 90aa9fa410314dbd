#include "report/localization_summary.h"

#include <sys/resource.h>

#include <algorithm>
#include <iomanip>
#include <limits>
#include <nlohmann/json.hpp>

#include "common/atomic_output.h"
#include "common/executor.h"
#include "io/staged_output.h"
#include "report/json.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/io/trajectory.h"

namespace saw_ndt {

using namespace internal;

namespace {

double peakResidentMegabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

template <typename Field>
std::vector<double> collect(const DriveLocalization& run, Field field) {
  std::vector<double> values;
  values.reserve(run.results.size());
  for (const LocalizationResult& result : run.results) values.push_back(static_cast<double>(field(result)));
  return values;
}

/// In quotes where a comma or a quote would end it (RFC 4180).
std::string csvField(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

void writeFrames(const std::filesystem::path& path, const DriveLocalization& run) {
  AtomicOutput output(path);
  std::ostream& out = output.stream();
  out << "scan,stamp,accepted,reason,converged,iterations,likelihood,correction_m,correction_deg,source_points,"
         "segment_ms,filter_ms,align_ms,total_ms,file,state,evaluations,unweighted_likelihood,non_ground_likelihood,"
         "nearest_voxel_likelihood,degenerate,overlap,sigma_x_m,sigma_y_m,sigma_z_m,sigma_roll_deg,sigma_pitch_deg,"
         "sigma_yaw_deg,search\n";
  out << std::fixed;
  for (std::size_t i = 0; i < run.results.size(); ++i) {
    const LocalizationResult& r = run.results[i];
    out << run.scans[i] << ',' << std::setprecision(9) << r.stamp_s << ',' << r.accepted() << ','
        << toString(r.acceptance) << ',' << r.alignment.converged() << ',' << r.alignment.iterations << ','
        << std::setprecision(6) << r.alignment.likelihood << ',' << r.correction.distance_m << ','
        << degreesFromRadians(r.correction.angle_rad) << ',' << r.source_points << ',' << std::setprecision(3)
        << r.times.segment_ms << ',' << r.times.filter_ms << ',' << r.times.align_ms << ',' << r.times.total_ms << ','
        << csvField(run.names[i]) << ',' << toString(r.track.status) << ',' << r.alignment.evaluations << ','
        << std::setprecision(6) << r.alignment.likelihoods.unweighted << ',' << r.alignment.likelihoods.non_ground
        << ',' << r.alignment.likelihoods.nearest_voxel << ',' << freeAxes(r.free_directions, r.T_map_base.linear())
        << ',' << r.alignment.overlap;
    const Vector6d sigma = standardDeviations(r.covariance, r.T_map_base.linear());
    for (int k = 0; k < 6; ++k) out << ',' << (k < 3 ? sigma[k] : degreesFromRadians(sigma[k]));
    out << ',' << toString(r.search) << '\n';
  }
  output.commit();
}

/// The metrics of the pairs from `skip_s` after the first one on, where there are any. Pairs are of the same scan,
/// whatever the stamps say.
std::optional<TrajectoryMetrics> metricsAfter(double skip_s, std::vector<PosePair> pairs) {
  constexpr double kStampRounding_s = 1e-6;
  double first_s = std::numeric_limits<double>::infinity();
  for (const PosePair& pair : pairs) first_s = std::min(first_s, pair.stamp_s);
  pairs.erase(std::remove_if(pairs.begin(), pairs.end(),
                             [&](const PosePair& pair) { return pair.stamp_s < first_s + skip_s - kStampRounding_s; }),
              pairs.end());
  if (pairs.empty()) return std::nullopt;
  return evaluatePosePairs(pairs);
}

void addStates(const DriveLocalization& run, LocalizationSummary& summary) {
  for (std::size_t i = 0; i < run.results.size(); ++i) {
    const LocalizationResult& result = run.results[i];
    const TrackStatus status = result.track.status;
    StateShare& share = status == TrackStatus::LOST           ? summary.lost
                        : status == TrackStatus::RELOCALIZING ? summary.relocalizing
                        : status == TrackStatus::COASTING     ? summary.coasting
                                                              : summary.tracking;
    ++share.scans;
    if (result.accepted() && result.free_directions.cols() > 0) ++summary.degenerate_scans;
    if (i == 0) continue;
    share.seconds += std::max(0.0, result.stamp_s - run.results[i - 1].stamp_s);
    if (result.accepted() && !run.results[i - 1].accepted()) ++summary.recoveries;
  }
}

}  // namespace

bool anyScanAfterSkip(const std::vector<double>& stamps_s, double skip_s) {
  const auto [first, last] = std::minmax_element(stamps_s.begin(), stamps_s.end());
  return *last - *first >= skip_s;
}

LocalizationSummary summarize(const DriveLocalization& run, const LocalizerOptions& options, double skip_s) {
  using R = LocalizationResult;
  LocalizationSummary summary;
  summary.method = options.method.name;
  summary.motion_compensation = options.motion_compensation;
  summary.scans = run.results.size();
  addStates(run, summary);
  for (const R& result : run.results) ++(result.accepted() ? summary.accepted : summary.rejected);
  summary.total_ms = durationStatistics(collect(run, [](const R& r) { return r.times.total_ms; }));
  summary.segment_ms = durationStatistics(collect(run, [](const R& r) { return r.times.segment_ms; }));
  summary.filter_ms = durationStatistics(collect(run, [](const R& r) { return r.times.filter_ms; }));
  summary.align_ms = durationStatistics(collect(run, [](const R& r) { return r.times.align_ms; }));
  summary.source_points_mean = mean(collect(run, [](const R& r) { return r.source_points; }));
  summary.iterations_mean = mean(collect(run, [](const R& r) { return r.alignment.iterations; }));
  summary.evaluations_mean = mean(collect(run, [](const R& r) { return r.alignment.evaluations; }));
  summary.likelihood_mean = mean(collect(run, [](const R& r) { return r.alignment.likelihood; }));
  summary.nearest_voxel_likelihood_mean =
      mean(collect(run, [](const R& r) { return r.alignment.likelihoods.nearest_voxel; }));
  summary.non_ground_likelihood_mean =
      mean(collect(run, [](const R& r) { return r.alignment.likelihoods.non_ground; }));
  summary.peak_rss_mb = peakResidentMegabytes();
  summary.threads = internal::threadCount(options.alignment.threads);
  const Eigen::Isometry3d T_lidar_base = options.T_base_lidar.inverse();
  std::vector<PosePair> pairs;
  for (std::size_t i = 0; i < run.T_map_lidar_reference.size(); ++i) {
    const std::optional<Eigen::Isometry3d>& reference = run.T_map_lidar_reference[i];
    if (!reference || !run.results[i].track.pose_known) continue;
    pairs.push_back({run.results[i].stamp_s, *reference * T_lidar_base, run.results[i].T_map_base});
  }
  summary.metrics = metricsAfter(skip_s, pairs);
  return summary;
}

std::string toJsonText(const LocalizationSummary& summary) { return toJson(summary).dump(2) + "\n"; }

void writeLocalization(const std::filesystem::path& folder, const DriveLocalization& run,
                       const LocalizationSummary& summary, const Eigen::Isometry3d& T_base_lidar,
                       const Eigen::Isometry3d& T_camera_lidar) {
  std::vector<StampedPose> base_poses;
  std::vector<Eigen::Isometry3d> camera_poses;
  for (const LocalizationResult& result : run.results) {
    if (!result.track.pose_known) continue;
    base_poses.push_back({result.stamp_s, result.T_map_base});
    camera_poses.push_back(cameraPose(result.T_map_base * T_base_lidar, T_camera_lidar));
  }
  StagedOutput staged(folder);
  writeTumTrajectory(staged.folder() / "trajectory_tum.txt", base_poses);
  writeKittiTrajectory(staged.folder() / "trajectory_kitti.txt", camera_poses);
  writeFrames(staged.folder() / "frames.csv", run);
  AtomicOutput output(staged.folder() / "summary.json");
  output.stream() << toJsonText(summary);
  output.commit();
  staged.commit();
}

}  // namespace saw_ndt
