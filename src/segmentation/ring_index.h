#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "saw_ndt/common/scan_view.h"
#include "saw_ndt/common/sensor_model.h"
#include "segmentation/beam_matching.h"
#include "segmentation/point_measurements.h"
#include "segmentation/ring_runs.h"

namespace saw_ndt::internal {

/// What tells which beam measured a point, in order of preference.
enum class VerticalIndexSource {
  ORGANIZED_ROW,     ///< the row of an organized cloud with one row a beam
  ORGANIZED_COLUMN,  ///< its column, where it has one a beam
  RING_FIELD,        ///< the ring number of the points
  FILE_ORDER,        ///< points listed ring after ring, from one side of azimuth 0 round to the other, as KITTI does
  ELEVATION_TABLE,   ///< the beam of the sensor model that is nearest in elevation
};

/// Recovers the vertical scan index of every point of a scan.
class RingIndex {
 public:
  /// Row of a point that no beam of the sensor can have measured, or that has no range.
  static constexpr std::int16_t kNoRow = -1;

  /// Finds the row of every point by the best source that the scan has. Rows and rings of a scan may be numbered in any
  /// order: elevations tell. File order is taken only where it fits the beam table.
  /// @throws std::invalid_argument for a ring that the sensor cannot have
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
  /// Points of one row or ring number.
  struct GroupSum {
    float sine = 0.0F;
    std::uint32_t points = 0;
    float elevation_deg = 0.0F;
  };

  void assignFromElevation(const ScanView& scan, const PointMeasurements& points, const SensorModel& sensor);
  void assignFromRings(const ScanView& scan, const PointMeasurements& points, const SensorModel& sensor);
  template <typename GroupOfPoint>
  void orderGroups(const ScanView& scan, const PointMeasurements& points, std::size_t groups,
                   const GroupOfPoint& group_of_point, const SensorModel& sensor);
  bool matchRunsToBeams(const ScanView& scan, const PointMeasurements& points, const SensorModel& sensor);

  std::vector<std::int16_t> rows_;
  VerticalIndexSource source_ = VerticalIndexSource::ELEVATION_TABLE;
  std::vector<RowRun> runs_;
  std::vector<float> samples_;
  std::vector<float> run_elevations_;
  std::vector<float> run_spreads_;
  BeamMatching beams_;
  std::vector<GroupSum> group_sums_;
  std::vector<std::size_t> group_order_;
  std::vector<std::int16_t> row_of_group_;
  std::vector<std::uint8_t> row_is_taken_;
  std::vector<float> beam_sines_;
};

}  // namespace saw_ndt::internal
