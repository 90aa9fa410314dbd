#pragma once

#include <cstddef>
#include <cstdint>

namespace saw_ndt::internal {

// Points on their way into the voxels of a map, batch by batch. Loops are compiled for each instruction set.

constexpr std::size_t kPointsPerBatch = 1024;
constexpr std::size_t kMostLanes = 16;
/// Loops write whole vectors, which reach beyond the last point of a batch, and begin at any point.
constexpr std::size_t kBatchRoom = kPointsPerBatch + 2 * kMostLanes;

/// How source points move to the map. Positions are taken from the lower corner of an origin voxel near the source.
struct BatchPose {
  float rotation[9];     ///< row-major
  float translation[3];  ///< m, from the origin voxel
  float resolution_m;
  float inverse_resolution;
};

/// The points of a batch at one pose, an array a coordinate.
struct alignas(64) BatchPoints {
  float rotated[3][kBatchRoom];         ///< R p (m)
  float from_centre[3][kBatchRoom];     ///< T p from the centre of its own voxel (m)
  std::int32_t voxel[3][kBatchRoom];    ///< its own voxel, counted from the origin voxel
  std::int32_t run_starts[kBatchRoom];  ///< where another voxel begins, then the number of points
  std::size_t run_count;
};

/// Edge of the square of columns that a key tells apart; columns farther out share the keys of nearer ones.
constexpr int kColumnBits = 6;
constexpr std::size_t kColumnKeys = std::size_t{1} << (2 * kColumnBits);

/// Writes for every point the number of the vertical column that it lies in, row by row.
void findColumns(const float* x, const float* y, std::size_t count, float inverse_column_m, std::uint16_t* columns);

/// Moves `count` points and finds their runs. The arrays reach 2 kMostLanes finite values beyond the last point.
void transformBatch(const float* x, const float* y, const float* z, std::size_t count, const BatchPose& pose,
                    BatchPoints& points);

}  // namespace saw_ndt::internal
