#include "registration/batch_voxel_finder.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace saw_ndt::internal {
namespace {

// Neighbours that have the same y and z, in the order of their places in a row.
struct NeighbourRow {
  int dy, dz;
  bool whole;  // dx is -1, 0 and 1, otherwise 0
};

// Four floats are read of a cell and written of a voxel at once.
static_assert(offsetof(internal::PackedNdtCell, mean_from_centre) == 0 && alignof(internal::PackedNdtCell) >= 16);
static_assert(offsetof(RunVoxel, mean) == 0 && sizeof(RunVoxel) == 16 && alignof(RunVoxel) == 16);

constexpr NeighbourRow kOwnVoxel[] = {{0, 0, false}};
constexpr NeighbourRow kAboveAndBelow[] = {{0, -1, false}, {0, 0, false}, {0, 1, false}};
constexpr NeighbourRow kSharedFaces[] = {{0, -1, false}, {-1, 0, false}, {0, 0, true}, {1, 0, false}, {0, 1, false}};
constexpr NeighbourRow kAllAround[] = {{-1, -1, true}, {0, -1, true}, {1, -1, true}, {-1, 0, true}, {0, 0, true},
                                       {1, 0, true},   {-1, 1, true}, {0, 1, true},  {1, 1, true}};

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

BatchVoxelFinder::BatchVoxelFinder(const internal::NdtLevel& level, NeighborhoodSearchMethod method,
                                   const Eigen::Isometry3d& T_map_source)
    : level_(level), method_(method) {
  const AnchoredPose anchored(T_map_source, level.resolution());
  origin_ = anchored.origin;
  pose_ = anchored.pose;
}

void BatchVoxelFinder::place(OrderedSource& source, std::size_t first, std::size_t count, BatchScratch& scratch) const {
  move(source, first, count, scratch);
  if (source.mixedUp(first, scratch.points.run_count)) {
    source.regroup(first, scratch.points);
    move(source, first, count, scratch);
  }
}

void BatchVoxelFinder::find(OrderedSource& source, std::size_t first, std::size_t count, BatchScratch& scratch) const {
  place(source, first, count, scratch);
  findVoxels(scratch);
  cutIntoUnits(scratch);
}

void BatchVoxelFinder::findInOrder(const OrderedSource& source, std::size_t first, std::size_t count,
                                   BatchScratch& scratch) const {
  move(source, first, count, scratch);
  findVoxels(scratch);
  cutIntoUnits(scratch);
}

void BatchVoxelFinder::move(const OrderedSource& source, std::size_t first, std::size_t count,
                            BatchScratch& scratch) const {
  transformBatch(source.x() + first, source.y() + first, source.z() + first, count, pose_, scratch.points);
}

void BatchVoxelFinder::findVoxels(BatchScratch& scratch) const {
  switch (method_) {
    case NeighborhoodSearchMethod::DIRECT3:
      return findVoxelsIn(kAboveAndBelow, scratch);
    case NeighborhoodSearchMethod::DIRECT1:
      return findVoxelsIn(kOwnVoxel, scratch);
    case NeighborhoodSearchMethod::DIRECT7:
      return findVoxelsIn(kSharedFaces, scratch);
    case NeighborhoodSearchMethod::DIRECT26:
    case NeighborhoodSearchMethod::RADIUS:
      return findVoxelsIn(kAllAround, scratch);
  }
}

template <typename NeighbourRows>
void BatchVoxelFinder::findVoxelsIn(const NeighbourRows& neighbour_rows, BatchScratch& scratch) const {
  internal::VoxelIndex::Cursor cursor;
  const BatchPoints& points = scratch.points;
  const internal::PackedNdtCell* const cells = level_.packedCells().data();
  // Four lanes at a time, where a neighbour's own voxel lies from that of the run (m); the last lane is written over.
  const auto edge_m = static_cast<float>(level_.resolution());
  std::array<Eigen::Array4f, kMostNeighbours> shifts_m;
  std::size_t neighbour_count = 0;
  for (const NeighbourRow& row : neighbour_rows) {
    for (int dx = row.whole ? -1 : 0; dx <= (row.whole ? 1 : 0); ++dx) {
      shifts_m[neighbour_count++] = Eigen::Array4f(static_cast<float>(dx) * edge_m, static_cast<float>(row.dy) * edge_m,
                                                   static_cast<float>(row.dz) * edge_m, 0.0F);
    }
  }
  RunVoxel* voxel = scratch.voxels.voxels;
  for (std::size_t run = 0; run < points.run_count; ++run) {
    scratch.voxels.first[run] = static_cast<std::uint32_t>(voxel - scratch.voxels.voxels);
    const auto start = static_cast<std::size_t>(points.run_starts[run]);
    const VoxelCoordinate own(points.voxel[0][start], points.voxel[1][start], points.voxel[2][start]);
    const internal::VoxelIndex::Place place = level_.index().place(own + origin_, cursor);
    if (!place) continue;
    const Eigen::Array4f* shift_m = shifts_m.data();
    // Whether a neighbour exists is as good as random: each is written, and kept by moving on. Voxel 0 stands for none.
    const auto write = [&](std::uint32_t exists, std::uint32_t rank) {
      const std::uint32_t number = static_cast<std::uint32_t>(place.numbers[rank]) & (0U - exists);
      const auto* const cell = reinterpret_cast<const float*>(cells + number);
      Eigen::Map<Eigen::Array4f, Eigen::Aligned16>(reinterpret_cast<float*>(voxel)) =
          Eigen::Map<const Eigen::Array4f, Eigen::Aligned16>(cell) + *shift_m++;
      voxel->number = number;
      voxel += exists;
    };
    for (const NeighbourRow& row : neighbour_rows) {
      const internal::VoxelIndex::Row in_row = place.row[internal::VoxelIndex::rowOffset(row.dy, row.dz)];
      if (!row.whole) {
        write(in_row.has(place.x), in_row.rank(place.x));
        continue;
      }
      std::uint32_t rank = in_row.rank(place.x - 1U);
      for (std::uint32_t x = place.x - 1U; x <= place.x + 1U; ++x) {
        const std::uint32_t exists = in_row.has(x);
        write(exists, rank);
        rank += exists;
      }
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

}  // namespace saw_ndt::internal
