#include "moving_truth.h"

#include <algorithm>
#include <numeric>

#include "saw_ndt/segmentation/scan_segmenter.h"

namespace saw_ndt {
namespace {

PointKind kindOf(std::uint16_t semantic_class) {
  if (semantic_class >= 252) return PointKind::MOVING;
  switch (semantic_class) {
    case 10:
    case 13:
    case 18:
    case 20:
    case 30:
      return PointKind::PARKED;
    case 40:
    case 44:
    case 48:
    case 49:
    case 60:
    case 72:
      return PointKind::GROUND;
    case 50:
      return PointKind::FACADE;
    case 51:
    case 52:
      return PointKind::BARRIER;
    case 70:
    case 71:
      return PointKind::VEGETATION;
    case 80:
    case 81:
      return PointKind::POLE;
    case 0:
    case 1:
      return PointKind::UNLABELLED;
    default:
      return PointKind::OTHER;
  }
}

std::vector<VoxelCoordinate> voxelsOf(const WeightedVoxelMap& map) {
  std::vector<VoxelCoordinate> voxels;
  for (const LabelledVoxelSums& entry : map.entries()) {
    if (voxels.empty() || entry.voxel != voxels.back()) voxels.push_back(entry.voxel);
  }
  return voxels;
}

std::uint64_t sumOf(const PointCounts& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

double share(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

const std::array<const char*, kPointKinds>& pointKindNames() {
  static const std::array<const char*, kPointKinds> names = {"moving",     "parked", "ground", "facade",    "barrier",
                                                             "vegetation", "pole",   "other",  "unlabelled"};
  return names;
}

double RemovalScore::removedShare(PointKind kind) const {
  const auto k = static_cast<std::size_t>(kind);
  return share(removed[k], points[k]);
}

double RemovalScore::removedStaticShare() const {
  return share(sumOf(removed) - removed.front() - removed.back(), sumOf(points) - points.front() - points.back());
}

double RemovalScore::precision() const { return share(removed.front(), sumOf(removed) - removed.back()); }

MovingTruth::MovingTruth(const KittiSequence& sequence, const std::vector<int>& scans, const DriveMapOptions& options,
                         const WeightedVoxelMap& map)
    : index_(voxelsOf(map)), counts_(map.entries().size()) {
  ScanSegmenter segmenter(options.segmentation.value_or(SegmentationOptions()));
  std::vector<StructuralLabel> labels;
  for (const int scan : scans) {
    ScanPoints points;
    sequence.readScan(scan, points);
    const std::vector<std::uint16_t> classes = sequence.readLabels(scan);
    labels.assign(points.points.size(), StructuralLabel::NON_GROUND);
    if (options.segmentation) segmenter.segment(viewOf(points), labels, options.threads);
    const Eigen::Isometry3d T_map_lidar = sequence.referencePose(scan).value();
    for (std::size_t i = 0; i < classes.size(); ++i) {
      QuantizedPosition position;
      const Eigen::Vector3d in_map = T_map_lidar * positionOf(points.points[i]).cast<double>();
      if (!quantize(in_map, 1.0 / map.resolution(), position)) continue;
      const std::int32_t voxel = index_.find(position.voxel);
      // No voxel: a point on a border, which a rounding put beside it.
      if (voxel == internal::VoxelIndex::kNone) continue;
      OfLabels& of_labels = counts_[static_cast<std::size_t>(voxel)];
      ++of_labels[static_cast<std::size_t>(labels[i])][static_cast<std::size_t>(kindOf(classes[i]))];
    }
  }
}

RemovalScore MovingTruth::score(const WeightedVoxelMap& map, const WeightedVoxelMap& remaining) const {
  RemovalScore score;
  auto kept = remaining.entries().begin();
  std::size_t voxel = 0;
  for (auto entry = map.entries().begin(); entry != map.entries().end(); ++voxel) {
    PointCounts not_ground{};
    bool removed = false;
    const VoxelCoordinate at = entry->voxel;
    for (; entry != map.entries().end() && entry->voxel == at; ++entry) {
      const PointCounts& points = counts_[voxel][static_cast<std::size_t>(entry->label)];
      const bool stays = kept != remaining.entries().end() && kept->voxel == at && kept->label == entry->label;
      if (stays) ++kept;
      removed = removed || !stays;
      for (std::size_t kind = 0; kind < kPointKinds; ++kind) {
        score.points[kind] += points[kind];
        if (!stays) score.removed[kind] += points[kind];
        if (entry->label != StructuralLabel::GROUND) not_ground[kind] += points[kind];
      }
    }
    const bool moving = 2 * not_ground[0] > sumOf(not_ground);
    score.moving_voxels += moving ? 1 : 0;
    score.removed_moving_voxels += moving && removed ? 1 : 0;
  }
  return score;
}

}  // namespace saw_ndt
