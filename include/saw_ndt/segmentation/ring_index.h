#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "saw_ndt/common/sensor_model.h"
#include "saw_ndt/segmentation/scan_view.h"

namespace saw_ndt {

/// What tells which beam measured a point, in order of preference.
enum class VerticalIndexSource {
  OrganizedRow,    ///< the row of an organized cloud with one row a beam
  RingField,       ///< the ring number of the points
  FileOrder,       ///< points listed ring after ring from the top, azimuth rising from 0 to 360 degrees (as KITTI does)
  ElevationTable,  ///< the beam of the sensor model that is nearest in elevation
};

/// What projection needs of every point, in input order. Memory is kept between scans.
struct PointMeasurements {
  std::vector<std::int32_t> column;     ///< of the range image; means nothing where range is 0
  std::vector<float> range;             ///< metres; 0 where the point is not finite or at the origin
  std::vector<float> horizontal_range;  ///< metres, levelled
  std::vector<float> height;            ///< metres, levelled
};

/// Recovers the vertical scan index of every point of a scan.
class RingIndex {
 public:
  /// Row of a point that no beam of the sensor can have measured, or that has no range.
  static constexpr std::int16_t kNoRow = -1;

  /// Finds the row of every point by the best source that the scan has. Row and ring numbers of a scan count from the
  /// top or from the bottom; which of the two is told by the elevations. File order is taken only where it fits the
  /// beam table.
  void assign(const ScanView& scan, const PointMeasurements& points, const SensorModel& sensor);

  /// Row of each point, 0 at the top, or kNoRow.
  const std::vector<std::int16_t>& rows() const { return rows_; }
  VerticalIndexSource source() const { return source_; }

 private:
  bool findRuns(const ScanView& scan, const PointMeasurements& points, const SensorModel& sensor);
  bool assignFromFileOrder(const ScanView& scan, const PointMeasurements& points, const SensorModel& sensor);
  void assignFromElevation(const ScanView& scan, const PointMeasurements& points, const SensorModel& sensor);
  void putLowestRowLast(const ScanView& scan, const PointMeasurements& points, const SensorModel& sensor);
  bool matchRunsToBeams(const ScanView& scan, const PointMeasurements& points, const SensorModel& sensor);

  std::vector<std::int16_t> rows_;
  VerticalIndexSource source_ = VerticalIndexSource::ElevationTable;
  std::vector<std::size_t> run_starts_;
  std::vector<std::int16_t> row_of_run_;
  std::vector<float> samples_;
  std::vector<float> run_elevations_;
  std::vector<float> run_spreads_;
  std::vector<float> costs_;
  std::vector<std::uint8_t> taken_;
  std::vector<float> beam_sines_;
};

}  // namespace saw_ndt
