#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "saw_ndt/common/scan_view.h"
#include "saw_ndt/common/sensor_model.h"

namespace saw_ndt::internal {

/// What tells which beam measured a point, in order of preference.
enum class VerticalIndexSource {
  ORGANIZED_ROW,  ///< the row of an organized cloud with one row a beam
  RING_FIELD,     ///< the ring number of the points
  FILE_ORDER,     ///< points listed ring after ring from the top, azimuth rising from 0 to 360 degrees (as KITTI does)
  ELEVATION_TABLE,  ///< the beam of the sensor model that is nearest in elevation
};

/// Least and greatest column of some points; the least is above the greatest where none of them has a column.
struct ColumnSpan {
  std::uint16_t least;
  std::uint16_t greatest;
};

/// What projection needs of every point, in input order. Memory is kept between scans.
struct PointMeasurements {
  /// Column of a point that is not finite or at the origin.
  static constexpr std::uint16_t kNoColumn = 0xFFFF;
  /// How many points share an element of `spans`.
  static constexpr std::size_t kBlock = 128;

  std::vector<std::uint16_t> column;    ///< of the range image, or kNoColumn
  std::vector<float> range;             ///< metres; 0 where the point is not finite or at the origin
  std::vector<float> horizontal_range;  ///< metres, levelled
  std::vector<float> height;            ///< metres, levelled
  std::vector<ColumnSpan> spans;        ///< of every kBlock points
};

/// Successive points of one row.
struct RowRun {
  std::size_t begin;
  std::size_t end;
  std::int16_t row;
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

  /// Whether the scan lists its points row after row, each row once, as organized clouds and those in file order do.
  bool rowAfterRow() const {
    return source_ == VerticalIndexSource::ORGANIZED_ROW || source_ == VerticalIndexSource::FILE_ORDER;
  }
  /// Rows of a scan that lists them one after the other, in the order of the scan; together they hold every point.
  const std::vector<RowRun>& runs() const { return runs_; }
  /// Row of each point of another scan, 0 at the top, or kNoRow.
  const std::vector<std::int16_t>& rows() const { return rows_; }
  VerticalIndexSource source() const { return source_; }

 private:
  bool findRuns(const ScanView& scan, const PointMeasurements& points, const SensorModel& sensor);
  bool assignFromFileOrder(const ScanView& scan, const PointMeasurements& points, const SensorModel& sensor);
  void assignFromElevation(const ScanView& scan, const PointMeasurements& points, const SensorModel& sensor);
  bool rowsRise(const ScanView& scan, const PointMeasurements& points, const SensorModel& sensor) const;
  bool matchRunsToBeams(const ScanView& scan, const PointMeasurements& points, const SensorModel& sensor);

  std::vector<std::int16_t> rows_;
  VerticalIndexSource source_ = VerticalIndexSource::ELEVATION_TABLE;
  std::vector<RowRun> runs_;
  std::vector<float> samples_;
  std::vector<float> run_elevations_;
  std::vector<float> run_spreads_;
  std::vector<float> costs_;
  std::vector<std::uint8_t> taken_;
  std::vector<float> beam_sines_;
};

}  // namespace saw_ndt::internal
