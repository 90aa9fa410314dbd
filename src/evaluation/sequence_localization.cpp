#include "saw_ndt/evaluation/sequence_localization.h"

#include <sys/resource.h>
#include <unistd.h>

#include <iomanip>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/common/threads.h"
#include "saw_ndt/evaluation/json.h"
#include "saw_ndt/io/atomic_output.h"
#include "saw_ndt/io/trajectory.h"
#include "saw_ndt/segmentation/cloud_view.h"

namespace saw_ndt {
namespace {

double peakResidentMegabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

template <typename Field>
std::vector<double> collect(const SequenceLocalization& run, Field field) {
  std::vector<double> values;
  values.reserve(run.results.size());
  for (const LocalizationResult& result : run.results) values.push_back(static_cast<double>(field(result)));
  return values;
}

/// Files that appear in a folder all together: they are written into a folder within it and moved by commit(). Without
/// commit() those that were there stay as they were and nothing is left behind.
class StagedFiles {
 public:
  /// @throws Error where one of the names is taken by a folder, or nothing can be written
  StagedFiles(const std::filesystem::path& target, std::vector<std::string> names)
      : target_(target), folder_(target / (".saw_ndt-" + std::to_string(getpid()))), names_(std::move(names)) {
    std::error_code error;
    for (const std::string& name : names_) {
      if (std::filesystem::is_directory(target_ / name, error))
        throw Error((target_ / name).string(), "", "is a folder");
    }
    std::filesystem::create_directory(folder_, error);
    if (error) throw Error(target.string(), "", error.message());
  }
  ~StagedFiles() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  StagedFiles(const StagedFiles&) = delete;
  StagedFiles& operator=(const StagedFiles&) = delete;

  const std::filesystem::path& folder() const { return folder_; }

  /// @throws Error
  void commit() const {
    for (const std::string& name : names_) {
      std::error_code error;
      std::filesystem::rename(folder_ / name, target_ / name, error);
      if (error) throw Error((target_ / name).string(), "", error.message());
    }
  }

 private:
  std::filesystem::path target_, folder_;
  std::vector<std::string> names_;
};

void writeFrames(const std::filesystem::path& path, const SequenceLocalization& run) {
  AtomicOutput output(path);
  std::ostream& out = output.stream();
  out << "scan,stamp,accepted,reason,converged,iterations,likelihood,correction_m,correction_deg,source_points,"
         "segment_ms,filter_ms,align_ms,total_ms,evaluations,unweighted_likelihood,non_ground_likelihood,"
         "nearest_voxel_likelihood\n";
  out << std::fixed;
  for (std::size_t i = 0; i < run.results.size(); ++i) {
    const LocalizationResult& r = run.results[i];
    out << run.scans[i] << ',' << std::setprecision(9) << r.stamp_s << ',' << r.accepted() << ','
        << toString(r.acceptance) << ',' << r.alignment.converged() << ',' << r.alignment.iterations << ','
        << std::setprecision(6) << r.alignment.likelihood << ',' << r.correction_m << ','
        << degreesFromRadians(r.correction_rad) << ',' << r.source_points << ',' << std::setprecision(3)
        << r.times.segment_ms << ',' << r.times.filter_ms << ',' << r.times.align_ms << ',' << r.times.total_ms << ','
        << r.alignment.evaluations << ',' << std::setprecision(6) << r.likelihoods.unweighted << ','
        << r.likelihoods.non_ground << ',' << r.likelihoods.nearest_voxel << '\n';
  }
  output.commit();
}

}  // namespace

SequenceLocalization localizeSequence(Localizer& localizer, const KittiSequence& sequence,
                                      const std::vector<int>& scans, const std::function<void()>& scan_done) {
  const std::vector<double> stamps_s = sequence.stamps();
  SequenceLocalization run;
  run.scans = scans;
  for (const int scan : scans) {
    const pcl::PointCloud<pcl::PointXYZI> cloud = sequence.readScan(scan);
    run.results.push_back(localizer.localize(viewOf(cloud), stamps_s[static_cast<std::size_t>(scan)]));
    if (scan_done) scan_done();
  }
  return run;
}

LocalizationSummary summarize(const SequenceLocalization& run, const LocalizerOptions& options,
                              const std::vector<Eigen::Isometry3d>& reference_lidar,
                              const std::vector<double>& stamps_s, double skip_s) {
  using R = LocalizationResult;
  LocalizationSummary summary;
  summary.method = options.method.name;
  summary.scans = run.results.size();
  for (const R& result : run.results) ++(result.accepted() ? summary.accepted : summary.rejected);
  summary.total_ms = durationStatistics(collect(run, [](const R& r) { return r.times.total_ms; }));
  summary.segment_ms = durationStatistics(collect(run, [](const R& r) { return r.times.segment_ms; }));
  summary.filter_ms = durationStatistics(collect(run, [](const R& r) { return r.times.filter_ms; }));
  summary.align_ms = durationStatistics(collect(run, [](const R& r) { return r.times.align_ms; }));
  summary.source_points_mean = mean(collect(run, [](const R& r) { return r.source_points; }));
  summary.iterations_mean = mean(collect(run, [](const R& r) { return r.alignment.iterations; }));
  summary.evaluations_mean = mean(collect(run, [](const R& r) { return r.alignment.evaluations; }));
  summary.likelihood_mean = mean(collect(run, [](const R& r) { return r.alignment.likelihood; }));
  summary.nearest_voxel_likelihood_mean = mean(collect(run, [](const R& r) { return r.likelihoods.nearest_voxel; }));
  summary.non_ground_likelihood_mean = mean(collect(run, [](const R& r) { return r.likelihoods.non_ground; }));
  summary.peak_rss_mb = peakResidentMegabytes();
  summary.threads = threadCount(options.alignment.threads);
  if (!reference_lidar.empty()) {
    const Eigen::Isometry3d T_lidar_base = options.T_base_lidar.inverse();
    std::vector<StampedPose> reference, estimate;
    for (std::size_t i = 0; i < run.results.size(); ++i) {
      const auto scan = static_cast<std::size_t>(run.scans[i]);
      reference.push_back({stamps_s.at(scan), reference_lidar.at(scan) * T_lidar_base});
      estimate.push_back({run.results[i].stamp_s, run.results[i].T_map_base});
    }
    summary.metrics = evaluateTrajectory(reference, estimate, skip_s);
  }
  return summary;
}

std::string toJsonText(const LocalizationSummary& summary) {
  nlohmann::ordered_json json;
  json["method"] = summary.method;
  json["scans"] = summary.scans;
  json["accepted"] = summary.accepted;
  json["rejected"] = summary.rejected;
  json["total_ms"] = toJson(summary.total_ms);
  json["segment_ms"] = toJson(summary.segment_ms);
  json["filter_ms"] = toJson(summary.filter_ms);
  json["align_ms"] = toJson(summary.align_ms);
  json["source_points_mean"] = summary.source_points_mean;
  json["iterations_mean"] = summary.iterations_mean;
  json["evaluations_mean"] = summary.evaluations_mean;
  json["likelihood_mean"] = summary.likelihood_mean;
  json["nearest_voxel_likelihood_mean"] = summary.nearest_voxel_likelihood_mean;
  json["non_ground_likelihood_mean"] = summary.non_ground_likelihood_mean;
  json["peak_rss_mb"] = summary.peak_rss_mb;
  json["threads"] = summary.threads;
  if (summary.metrics) json.update(toJson(*summary.metrics));
  return json.dump(2) + "\n";
}

void writeLocalization(const std::filesystem::path& folder, const SequenceLocalization& run,
                       const LocalizationSummary& summary, const Eigen::Isometry3d& T_base_lidar,
                       const Eigen::Isometry3d& T_camera_lidar) {
  std::vector<StampedPose> base_poses;
  std::vector<Eigen::Isometry3d> camera_poses;
  for (const LocalizationResult& result : run.results) {
    base_poses.push_back({result.stamp_s, result.T_map_base});
    camera_poses.push_back(cameraPose(result.T_map_base * T_base_lidar, T_camera_lidar));
  }
  const StagedFiles staged(folder, {"trajectory_tum.txt", "trajectory_kitti.txt", "frames.csv", "summary.json"});
  writeTumTrajectory(staged.folder() / "trajectory_tum.txt", base_poses);
  writeKittiTrajectory(staged.folder() / "trajectory_kitti.txt", camera_poses);
  writeFrames(staged.folder() / "frames.csv", run);
  AtomicOutput output(staged.folder() / "summary.json");
  output.stream() << toJsonText(summary);
  output.commit();
  staged.commit();
}

}  // namespace saw_ndt
