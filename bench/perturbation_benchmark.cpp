// Aligns real scans from perturbed starts and prints how far, how fast and how repeatably each method comes back to the
// reference pose, pcl::NormalDistributionsTransform beside ours.

#include <functional>
#include <iomanip>
#include <iostream>

#include "app_options.h"
#include "common/stopwatch.h"
#include "evaluation/statistics.h"
#include "perturbed_starts.h"
#include "progress_bar.h"
#include "report/pcl_ndt.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/drives/drive_map.h"
#include "saw_ndt/drives/kitti_sequence.h"
#include "saw_ndt/drives/scan_selection.h"
#include "saw_ndt/localization/localizer.h"

namespace {

using Scan = std::vector<saw_ndt::LidarPoint>;

constexpr double kSuccess_m = 0.1;
constexpr double kSuccess_deg = 0.2;

struct Alignment {
  Eigen::Isometry3d T_map_lidar;
  double align_ms = 0.0;
  int evaluations = 0;
};

// Aligns one scan from one start.
using Method = std::function<Alignment(const Scan& scan, const Eigen::Isometry3d& T_start)>;

Method ourMethod(const std::string& name, const saw_ndt::WeightedVoxelMap& map, int threads) {
  saw_ndt::LocalizerOptions options;
  options.method = saw_ndt::LocalizationMethod::named(name);
  options.alignment.threads = threads;
  auto localizer = std::make_shared<saw_ndt::Localizer>(map, options);
  return [localizer](const Scan& scan, const Eigen::Isometry3d& T_start) {
    localizer->setInitialPose(T_start);
    const saw_ndt::LocalizationResult result = localizer->localize(saw_ndt::viewOf(scan), 0.0);
    return Alignment{result.alignment.T_map_source, result.times.align_ms, result.alignment.evaluations};
  };
}

Method pclMethod(const saw_ndt::PclNdt::Cloud::ConstPtr& target) {
  auto ndt = std::make_shared<saw_ndt::PclNdt>(target);
  return [ndt](const Scan& scan, const Eigen::Isometry3d& T_start) {
    const auto raw = pcl::make_shared<saw_ndt::PclNdt::Cloud>();
    for (const saw_ndt::LidarPoint& point : scan) raw->emplace_back(point.x, point.y, point.z);
    ndt->setSource(saw_ndt::PclNdt::thinned(raw));
    const saw_ndt::internal::Stopwatch stopwatch;
    const saw_ndt::AlignmentResult result = ndt->align(T_start);
    return Alignment{result.T_map_source, stopwatch.milliseconds(), 0};
  };
}

struct Figures {
  std::vector<double> align_ms, error_m, error_deg, spread_m, evaluations;
  int successes = 0;
};

void measure(const Method& method, const Scan& scan, const Eigen::Isometry3d& T_reference, Figures& figures) {
  std::vector<Eigen::Vector3d> positions;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (int k = 0; k < saw_ndt::kPerturbedStartCount; ++k) {
    const Alignment alignment = method(scan, saw_ndt::perturbedStart(T_reference, k));
    const double error_m = (alignment.T_map_lidar.translation() - T_reference.translation()).norm();
    const double error_deg = saw_ndt::degreesFromRadians(
        saw_ndt::rotationAngle(T_reference.linear().transpose() * alignment.T_map_lidar.linear()));
    figures.align_ms.push_back(alignment.align_ms);
    figures.evaluations.push_back(alignment.evaluations);
    figures.error_m.push_back(error_m);
    figures.error_deg.push_back(error_deg);
    figures.successes += error_m < kSuccess_m && error_deg < kSuccess_deg;
    positions.push_back(alignment.T_map_lidar.translation());
    mean += positions.back() / saw_ndt::kPerturbedStartCount;
  }
  for (const Eigen::Vector3d& position : positions) figures.spread_m.push_back((position - mean).norm());
}

void print(const std::string& name, const Figures& f) {
  using saw_ndt::internal::percentile;
  std::cout << std::fixed << "| " << name << " | " << std::setprecision(1) << percentile(f.align_ms, 50) << " / "
            << percentile(f.align_ms, 90) << " | " << std::setprecision(4) << percentile(f.error_m, 50) << " / "
            << percentile(f.error_m, 90) << " / " << percentile(f.error_m, 100) << " | " << percentile(f.error_deg, 50)
            << " / " << percentile(f.error_deg, 90) << " | " << std::setprecision(6) << percentile(f.spread_m, 50)
            << " / " << percentile(f.spread_m, 90) << " | " << std::setprecision(3)
            << static_cast<double>(f.successes) / static_cast<double>(f.error_m.size()) << " | ";
  if (percentile(f.evaluations, 100) > 0.0) {
    std::cout << std::setprecision(1) << saw_ndt::internal::mean(f.evaluations) << " / " << std::setprecision(0)
              << percentile(f.evaluations, 100);
  }
  std::cout << " |\n";
}

}  // namespace

int main(int argc, char** argv) {
  std::string sequence_folder, map_scans = "0:70:2", scans = "1:70:10";
  bool without_pcl = false;
  saw_ndt::AppOptions app(
      "perturbation_benchmark",
      "Aligns scans of a drive from ten perturbed starts each (0.5 m off in all directions, 0.1 m up "
      "or down, 1 degree of yaw) with pcl::NormalDistributionsTransform (epsilon 1e-4, one thread) "
      "and with this project's methods, and prints a table. Success: within 0.1 m and 0.2 degrees "
      "of the reference pose. Spread: distance of the ten final positions of a scan from their "
      "mean. Evaluations: mean / most, of score, gradient and Hessian on either level.");
  app.addPositional("SEQUENCE", &sequence_folder, "folder in KITTI layout");
  app.addOption("map-scans", &map_scans, "SLICE", "scans of the map");
  app.addOption("scans", &scans, "SLICE", "scans to align");
  app.addFlag("without-pcl", &without_pcl, "leave PCL out, which takes most of the time");

  return saw_ndt::runApp(argc, argv, app, [&] {
    const saw_ndt::KittiSequence sequence(sequence_folder);
    const std::vector<Eigen::Isometry3d> reference = sequence.posesLidar();
    const std::vector<int> mapped = saw_ndt::parseScanSelection(map_scans, sequence.scanCount());
    const std::vector<int> aligned = saw_ndt::parseScanSelection(scans, sequence.scanCount());
    const saw_ndt::WeightedVoxelMap map = saw_ndt::buildDriveMap(*sequence.scans(mapped), {}).build();

    std::vector<std::pair<std::string, Method>> methods;
    for (const std::string& name : saw_ndt::LocalizationMethod::names()) {
      methods.emplace_back(name, ourMethod(name, map, app.threads()));
    }
    if (!without_pcl) {
      const auto target = saw_ndt::mapPoints(*sequence.scans(mapped));
      methods.emplace_back("pcl::NormalDistributionsTransform", pclMethod(target));
    }

    std::vector<Figures> figures(methods.size());
    saw_ndt::ProgressBar progress(aligned.size() * methods.size());
    for (const int scan : aligned) {
      const Scan cloud = sequence.readScan(scan);
      // Methods take turns scan by scan, so that a slow minute of the machine hits all of them.
      for (std::size_t m = 0; m < methods.size(); ++m) {
        measure(methods[m].second, cloud, reference[static_cast<std::size_t>(scan)], figures[m]);
        progress.step();
      }
    }
    std::cout << "| method (" << app.threads() << " threads) | align ms median / p90 | error m median / p90 / max | "
              << "rotation deg median / p90 | spread m median / p90 | success | evaluations mean / most |\n"
              << "|---|---|---|---|---|---|---|\n";
    for (std::size_t m = 0; m < methods.size(); ++m) print(methods[m].first, figures[m]);
  });
}
