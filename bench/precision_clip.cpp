#include "precision_clip.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <memory>

#include "localization/source_voxel_filter.h"
#include "report/benchmark.h"
#include "report/pcl_ndt.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/drives/scan_selection.h"
#include "saw_ndt/map/weighted_map_builder.h"

namespace saw_ndt {
namespace {

PclNdt::Cloud::Ptr cloudOf(const LabelledScan& scan, const Eigen::Isometry3d& T) {
  auto cloud = pcl::make_shared<PclNdt::Cloud>();
  for (const LidarPoint& point : scan.points) {
    const Eigen::Vector3f moved = (T * Eigen::Vector3d(point.x, point.y, point.z)).cast<float>();
    if (moved.allFinite()) cloud->emplace_back(moved.x(), moved.y(), moved.z());
  }
  return cloud;
}

ScanAligner pclAligner(const std::vector<LabelledScan>& scans, const std::function<bool(std::size_t)>& picks) {
  auto points = pcl::make_shared<PclNdt::Cloud>();
  for (std::size_t i = 0; i < scans.size(); ++i) {
    if (picks(i)) *points += *cloudOf(scans[i], scans[i].T_map_lidar);
  }
  auto ndt = std::make_shared<PclNdt>(points);
  return [ndt](const LabelledScan& scan, const Eigen::Isometry3d& T_map_start) {
    ndt->setSource(PclNdt::thinned(cloudOf(scan, Eigen::Isometry3d::Identity())));
    return ndt->align(T_map_start).T_map_source;
  };
}

WeightedMapBuilder mapBuilder() { return WeightedMapBuilder(DriveMapOptions().resolution_m); }

void addTo(WeightedMapBuilder& map, const LabelledScan& scan, const Eigen::Isometry3d& T_map_lidar, int threads) {
  map.addScan(viewOf(scan.points), LabelView(scan.labels), T_map_lidar, threads);
}

}  // namespace

LabelledScan halfOf(const LabelledScan& scan, std::size_t first) {
  LabelledScan half;
  half.T_map_lidar = scan.T_map_lidar;
  for (std::size_t i = first; i < scan.points.size(); i += 2) {
    half.points.push_back(scan.points[i]);
    half.labels.push_back(scan.labels[i]);
  }
  return half;
}

std::vector<LabelledScan> labelledScans(const KittiSequence& sequence, int frame, int threads) {
  Eigen::Isometry3d T_frame_map = Eigen::Isometry3d::Identity();
  T_frame_map.linear() = rotationFromVector({0.0, 0.0, 0.7 * frame});
  T_frame_map.translation() = frame * Eigen::Vector3d(0.37, 0.81, 0.53);
  std::vector<LabelledScan> scans(static_cast<std::size_t>(sequence.scanCount()));
  ScanSegmenter segmenter;
  for (int i = 0; i < sequence.scanCount(); ++i) {
    LabelledScan& scan = scans[static_cast<std::size_t>(i)];
    scan.points = sequence.readScan(i);
    segmenter.segment(viewOf(scan.points), scan.labels, threads);
    scan.T_map_lidar = T_frame_map * sequence.posesLidar()[static_cast<std::size_t>(i)];
  }
  return scans;
}

ScanAligner alignerToMapOf(const std::vector<LabelledScan>& scans, const std::function<bool(std::size_t)>& picks,
                           const std::string& method, int threads) {
  if (method == kPclNdtMethod) return pclAligner(scans, picks);
  WeightedMapBuilder map = mapBuilder();
  for (std::size_t i = 0; i < scans.size(); ++i) {
    if (picks(i)) addTo(map, scans[i], scans[i].T_map_lidar, threads);
  }
  LocalizerOptions options;
  options.method = LocalizationMethod::named(method);
  options.alignment.threads = threads;
  const NdtTarget target(std::move(map).build(), options.method.voxels, threads);
  // A localizer's options are the alignment's as its method sets them.
  options = Localizer(target, options).options();
  const auto filter = std::make_shared<internal::SourceVoxelFilter>(options.source_voxel_size_m);
  const auto aligner = std::make_shared<NdtAligner>();
  return [=](const LabelledScan& scan, const Eigen::Isometry3d& T_map_start) {
    const internal::SourceSelection selection{options.method.ground_ratio, options.method.voxels.confidence,
                                              Eigen::Isometry3d::Identity()};
    const SourcePoints& source =
        filter->filter(viewOf(scan.points), options.method.segment ? &scan.labels : nullptr, selection);
    return aligner->align(target, source, T_map_start, options.alignment).T_map_source;
  };
}

std::vector<HalvesError> halvesErrors(const std::vector<LabelledScan>& scans, const std::string& method,
                                      double displacement_m, int threads, const std::function<void()>& scan_done) {
  const ScanAligner to_a = alignerToMapOf(
      scans, [](std::size_t i) { return i % 4 == 0; }, method, threads);
  const ScanAligner to_b = alignerToMapOf(
      scans, [](std::size_t i) { return i % 4 == 2; }, method, threads);
  std::vector<HalvesError> errors;
  for (std::size_t i = 1; i < scans.size(); i += 2) {
    Eigen::Isometry3d T_start_a = scans[i].T_map_lidar, T_start_b = T_start_a;
    // Another way for each scan.
    const double angle = 2.4 * static_cast<double>(i);
    const Eigen::Vector3d displacement = displacement_m * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0);
    T_start_a.translation() += displacement;
    T_start_b.translation() -= displacement;
    const Eigen::Isometry3d T_a = to_a(halfOf(scans[i], 0), T_start_a), T_b = to_b(halfOf(scans[i], 1), T_start_b);
    const Eigen::Isometry3d T_a_b = T_a.inverse() * T_b;
    errors.push_back(
        {T_a_b.translation().norm() / std::sqrt(2.0), std::abs(degreesFromRadians(heading(T_a_b))) / std::sqrt(2.0)});
    scan_done();
  }
  return errors;
}

double mapThickness(const std::vector<LabelledScan>& scans, const std::string& method, int threads) {
  constexpr std::uint64_t kLeastPoints = 20;
  ScanAligner align = [](const LabelledScan&, const Eigen::Isometry3d& T_map_start) { return T_map_start; };
  if (!method.empty()) {
    align = alignerToMapOf(
        scans, [](std::size_t i) { return i % 2 == 0; }, method, threads);
  }
  WeightedMapBuilder map = mapBuilder();
  for (std::size_t i = 1; i < scans.size(); i += 2) {
    addTo(map, scans[i], align(scans[i], scans[i].T_map_lidar), threads);
  }
  VoxelWeighting as_they_are;
  as_they_are.confidence = ConfidenceOptions::uniform();
  as_they_are.min_eigenvalue_ratio = 1e-9;
  double sum_m = 0.0;
  std::size_t count = 0;
  for (const VoxelStatistics& voxel : std::move(map).build().statistics(as_they_are, threads)) {
    if (voxel.structure_class != StructureClass::PLANAR || voxel.point_count < kLeastPoints) continue;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(voxel.covariance, Eigen::EigenvaluesOnly);
    sum_m += std::sqrt(std::max(0.0, solver.eigenvalues()[0]));
    ++count;
  }
  return count == 0 ? 0.0 : sum_m / static_cast<double>(count);
}

}  // namespace saw_ndt
