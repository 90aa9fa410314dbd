#include "registration/batch_voxel_finder.h"

#include <algorithm>

namespace saw_ndt {
namespace {

template <NeighborhoodSearchMethod method>
constexpr std::array<Neighbour, kNeighbourCount<method>> kNeighbours = neighbours<method>();

}  // namespace

AnchoredPose::AnchoredPose(const Eigen::Isometry3d& T_map_source, double resolution_m) {
  const Eigen::Vector3d origin_voxel = (T_map_source.translation() / resolution_m).array().floor();
  const Eigen::Vector3d translation = T_map_source.translation() - origin_voxel * resolution_m;
  origin = origin_voxel.cast<int>();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      pose.rotation[3 * row + column] = static_cast<float>(T_map_source.linear()(row, column));
    }
    pose.translation[row] = static_cast<float>(translation[row]);
  }
  pose.resolution_m = static_cast<float>(resolution_m);
  pose.inverse_resolution = static_cast<float>(1.0 / resolution_m);
}

BatchVoxelFinder::BatchVoxelFinder(const NdtLevel& level, NeighborhoodSearchMethod method,
                                   const Eigen::Isometry3d& T_map_source)
    : level_(level) {
  const auto take = [this, &level](const auto& all) {
    const auto resolution_m = static_cast<float>(level.resolution());
    for (const Neighbour& n : all) {
      shifts_[neighbour_count_++] = {n.offset, static_cast<float>(n.dx) * resolution_m,
                                     static_cast<float>(n.dy) * resolution_m, static_cast<float>(n.dz) * resolution_m};
    }
  };
  switch (method) {
    case NeighborhoodSearchMethod::DIRECT1:
      take(kNeighbours<NeighborhoodSearchMethod::DIRECT1>);
      break;
    case NeighborhoodSearchMethod::DIRECT7:
      take(kNeighbours<NeighborhoodSearchMethod::DIRECT7>);
      break;
    case NeighborhoodSearchMethod::DIRECT26:
    case NeighborhoodSearchMethod::RADIUS:
      take(kNeighbours<NeighborhoodSearchMethod::DIRECT26>);
      break;
  }
  const AnchoredPose anchored(T_map_source, level.resolution());
  origin_ = anchored.origin;
  pose_ = anchored.pose;
}

void BatchVoxelFinder::find(OrderedSource& source, std::size_t first, std::size_t count,
                            BatchScratch& scratch) const {
  BatchPoints& points = scratch.points;
  const auto transform = [&] {
    transformBatch(source.x() + first, source.y() + first, source.z() + first, count, pose_, points);
  };
  transform();
  if (source.mixedUp(first, points.run_count)) {
    source.regroup(first, points);
    transform();
  }
  findVoxels(scratch);
  cutIntoUnits(scratch);
}

void BatchVoxelFinder::findVoxels(BatchScratch& scratch) const {
  VoxelIndex::Cursor cursor;
  const BatchPoints& points = scratch.points;
  const PackedNdtCell* const cells = level_.packedCells().data();
  RunVoxel* voxel = scratch.voxels.voxels;
  for (std::size_t run = 0; run < points.run_count; ++run) {
    scratch.voxels.first[run] = static_cast<std::uint32_t>(voxel - scratch.voxels.voxels);
    const auto start = static_cast<std::size_t>(points.run_starts[run]);
    const VoxelCoordinate own(points.voxel[0][start], points.voxel[1][start], points.voxel[2][start]);
    const std::int32_t* const numbers = level_.index().cell(own + origin_, cursor);
    if (numbers == nullptr) continue;
    // Whether a neighbour exists is as good as random: each is written, and kept by moving on. Voxel 0 stands for none.
    for (std::size_t n = 0; n < neighbour_count_; ++n) {
      const Shift& shift = shifts_[n];
      const std::int32_t number = numbers[shift.offset];
      const std::int32_t kept = number & ~(number >> 31);
      const float* const mean = cells[kept].mean_from_centre;
      voxel->mean[0] = mean[0] + shift.x_m;
      voxel->mean[1] = mean[1] + shift.y_m;
      voxel->mean[2] = mean[2] + shift.z_m;
      voxel->number = static_cast<std::uint32_t>(kept);
      voxel += number >= 0 ? 1 : 0;
    }
  }
  scratch.voxels.first[points.run_count] = static_cast<std::uint32_t>(voxel - scratch.voxels.voxels);
}

// Units of runs that pair with equally many voxels stand together, each such class filled up to whole vectors.
void BatchVoxelFinder::cutIntoUnits(BatchScratch& scratch) const {
  const BatchPoints& points = scratch.points;
  const std::uint32_t* const first_voxel = scratch.voxels.first;
  const std::size_t unit_size = points_per_unit_;
  std::array<std::size_t, kMostNeighbours + 1> places{};
  for (std::size_t run = 0; run < points.run_count; ++run) {
    const auto length = static_cast<std::size_t>(points.run_starts[run + 1] - points.run_starts[run]);
    places[first_voxel[run + 1] - first_voxel[run]] += (length + unit_size - 1) / unit_size;
  }
  places[0] = 0;
  std::size_t begin = 0;
  for (std::size_t& place : places) {
    const std::size_t count = (place + units_per_vector_ - 1) / units_per_vector_ * units_per_vector_;
    place = begin;
    begin += count;
  }
  BatchUnits& units = scratch.units;
  units.count = begin;
  for (std::size_t run = 0; run < points.run_count; ++run) {
    const auto voxel_count = static_cast<std::uint8_t>(first_voxel[run + 1] - first_voxel[run]);
    if (voxel_count == 0) continue;
    const auto end = static_cast<std::size_t>(points.run_starts[run + 1]);
    std::size_t& place = places[voxel_count];
    for (auto i = static_cast<std::size_t>(points.run_starts[run]); i < end; i += unit_size) {
      units.units[place++] = {static_cast<std::uint16_t>(i), static_cast<std::uint8_t>(std::min(unit_size, end - i)),
                              voxel_count, first_voxel[run]};
    }
  }
  for (const std::size_t place : places) {
    for (std::size_t fill = place; fill % units_per_vector_ != 0; ++fill) {
      units.units[fill] = units.units[fill - 1];
      units.units[fill].point_count = 0;
    }
  }
}

}  // namespace saw_ndt
