#include "segmentation/point_measurements.h"

#include <algorithm>

#include "common/executor.h"
#include "saw_ndt/common/geometry.h"
#include "segmentation/range_image_loops.h"

namespace saw_ndt::internal {
namespace {

void leaveOutVehicle(const ScanView& scan, const Eigen::AlignedBox3f& vehicle, PointMeasurements& points) {
  for (std::size_t i = 0; i < scan.size; ++i) {
    if (!vehicle.contains(Eigen::Map<const Eigen::Vector3f>(scan.point(i)))) continue;
    points.column[i] = PointMeasurements::kNoColumn;
    points.range[i] = 0.0F;
  }
  constexpr std::size_t kBlock = PointMeasurements::kBlock;
  for (std::size_t block = 0; block < points.spans.size(); ++block) {
    ColumnSpan span = {PointMeasurements::kNoColumn, 0};
    for (std::size_t i = block * kBlock; i < std::min(scan.size, (block + 1) * kBlock); ++i) {
      const std::uint16_t column = points.column[i];
      if (column == PointMeasurements::kNoColumn) continue;
      span = {std::min(span.least, column), std::max(span.greatest, column)};
    }
    points.spans[block] = span;
  }
}

}  // namespace

void measureScan(const ScanView& scan, const ScanProjection& projection, int columns, int threads,
                 PointMeasurements& points) {
  constexpr std::size_t kBlock = PointMeasurements::kBlock;
  const std::size_t blocks = (scan.size + kBlock - 1) / kBlock;
  points.column.resize(scan.size);
  points.range.resize(scan.size);
  points.horizontal_range.resize(scan.size);
  points.height.resize(scan.size);
  points.spans.resize(blocks);
  const Eigen::RowVector3f up = projection.R_level_lidar.row(2);
  const ProjectionGeometry geometry = {static_cast<float>(columns) / static_cast<float>(2.0 * kPi),
                                       static_cast<float>(columns - 1),
                                       up.x(),
                                       up.y(),
                                       up.z(),
                                       projection.min_range_m,
                                       projection.max_range_m};
  constexpr std::size_t kBlocksAtOnce = 32;
  internal::forEachChunk(threads, (blocks + kBlocksAtOnce - 1) / kBlocksAtOnce, [&](std::size_t chunk, int) {
    const std::size_t begin = chunk * kBlocksAtOnce * kBlock;
    const std::size_t count = std::min(scan.size - begin, kBlocksAtOnce * kBlock);
    measurePoints(count, scan.stride, scan.point(begin), geometry,
                  {points.column.data() + begin, points.range.data() + begin, points.horizontal_range.data() + begin,
                   points.height.data() + begin, points.spans.data() + chunk * kBlocksAtOnce});
  });
  if (!projection.vehicle.isEmpty()) leaveOutVehicle(scan, projection.vehicle, points);
}

}  // namespace saw_ndt::internal
