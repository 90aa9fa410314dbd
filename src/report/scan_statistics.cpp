#include "report/scan_statistics.h"

#include <pcl/point_types.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <boost/container_hash/hash.hpp>
#include <cmath>
#include <tuple>
#include <unordered_set>

#include "evaluation/statistics.h"
#include "report/segmentation_score.h"
#include "saw_ndt/map/weighted_map_builder.h"
#include "saw_ndt/pcl/cloud_view.h"
#include "segmentation/segmentation_stages.h"

namespace saw_ndt {

using namespace internal;

namespace {

constexpr int kRingGroups = 8;

double occupiedVoxels(const ScanView& scan, float edge_m) {
  std::unordered_set<std::tuple<int, int, int>, boost::hash<std::tuple<int, int, int>>> voxels;
  const auto cell = [edge_m](float coordinate) { return static_cast<int>(std::floor(coordinate / edge_m)); };
  for (std::size_t i = 0; i < scan.size; ++i) {
    const float* p = scan.point(i);
    voxels.emplace(cell(p[0]), cell(p[1]), cell(p[2]));
  }
  return static_cast<double>(voxels.size());
}

/// Thickness (m) of the flat surfaces of one label, a quantile over its planar voxels of 1 m: what noise and offsets of
/// the beams make of a plane. 0 where there is none.
double surfaceThickness(const ScanView& scan, const std::vector<StructuralLabel>& labels, StructuralLabel label,
                        double percent) {
  constexpr std::uint64_t kFewestPoints = 50;
  pcl::PointCloud<pcl::PointXYZ> cloud;
  for (std::size_t i = 0; i < scan.size; ++i) {
    const float* p = scan.point(i);
    if (labels[i] == label) cloud.emplace_back(p[0], p[1], p[2]);
  }
  WeightedMapBuilder builder(1.0);
  addCloud(builder, cloud, Eigen::Isometry3d::Identity());
  VoxelWeighting weighting;
  weighting.min_eigenvalue_ratio = 1e-6;
  std::vector<double> thicknesses_m;
  for (const VoxelStatistics& voxel : std::move(builder).build().statistics(weighting, 1)) {
    if (voxel.structure_class != StructureClass::PLANAR || voxel.point_count < kFewestPoints) continue;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(voxel.covariance, Eigen::EigenvaluesOnly);
    thicknesses_m.push_back(std::sqrt(std::max(0.0, solver.eigenvalues()[0])));
  }
  return thicknesses_m.empty() ? 0.0 : percentile(thicknesses_m, percent);
}

}  // namespace

ScanStatistics scanStatistics(const ScanView& scan, const std::vector<std::uint16_t>& semantic_classes,
                              ScanSegmenter& segmenter) {
  std::vector<StructuralLabel> labels;
  segmenter.segment(scan, labels);
  const auto share = [&](StructuralLabel label) {
    const auto count = std::count(labels.begin(), labels.end(), label);
    return static_cast<double>(count) / static_cast<double>(std::max<std::size_t>(1, labels.size()));
  };
  ScanStatistics figures{{"points", static_cast<double>(scan.size)}};
  std::vector<double> ranges;
  for (std::size_t i = 0; i < scan.size; ++i) {
    const float* p = scan.point(i);
    ranges.push_back(std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]));
  }
  if (ranges.empty()) ranges.push_back(0.0);
  for (const int percent : {5, 25, 50, 75, 95}) {
    figures.emplace_back("range_p" + std::to_string(percent) + "_m", percentile(ranges, percent));
  }
  const RangeImage& image = segmenter.stages().image;
  std::vector<double> ring_points(kRingGroups, 0.0);
  for (const std::int32_t pixel : image.pixelOfPoint()) {
    if (pixel == RangeImage::kNoPixel) continue;
    const int group = pixel / image.columns() * kRingGroups / image.rows();
    ring_points[static_cast<std::size_t>(group)] += static_cast<double>(kRingGroups) / image.rows();
  }
  for (int group = 0; group < kRingGroups; ++group) {
    figures.emplace_back("points_a_ring_of_eighth_" + std::to_string(group + 1),
                         ring_points[static_cast<std::size_t>(group)]);
  }
  figures.emplace_back("voxels_of_1_m", occupiedVoxels(scan, 1.0f));
  figures.emplace_back("voxels_of_0.2_m", occupiedVoxels(scan, 0.2f));
  figures.emplace_back("ground_label_share", share(StructuralLabel::GROUND));
  figures.emplace_back("noise_label_share", share(StructuralLabel::NOISE));
  // Walls are rough and have windows: the lower quartile is more of a plane than the median.
  figures.emplace_back("ground_thickness_p50_m", surfaceThickness(scan, labels, StructuralLabel::GROUND, 50.0));
  figures.emplace_back("other_thickness_p25_m", surfaceThickness(scan, labels, StructuralLabel::NON_GROUND, 25.0));
  if (!semantic_classes.empty()) {
    double known = 0.0, ground = 0.0;
    for (const std::uint16_t semantic_class : semantic_classes) {
      known += semantic_class > 1;
      ground += isSemanticKittiGround(semantic_class);
    }
    figures.emplace_back("ground_class_share", known > 0.0 ? ground / known : 0.0);
  }
  return figures;
}

}  // namespace saw_ndt
