#include "segmentation/scan_projection.h"

#include <cmath>

#include "saw_ndt/common/geometry.h"

namespace saw_ndt::internal {
namespace {

// Of the axis from the vertical. A beam at the horizon then still meets the ground outward in its column.
constexpr double kGreatestLeanDeg = 50.0;

}  // namespace

ScanProjection::ScanProjection(const SegmentationOptions& options)
    : min_range_m(static_cast<float>(options.min_range_m)) {
  const double pitch = radiansFromDegrees(options.mounting_pitch_deg);
  const double roll = radiansFromDegrees(options.mounting_roll_deg);
  R_level_lidar =
      (Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()))
          .toRotationMatrix()
          .cast<float>();
  if (std::isfinite(options.max_range_m)) max_range_m = static_cast<float>(options.max_range_m);
  if (!options.vehicle_box_m.empty()) {
    const Eigen::Map<const Eigen::Matrix<double, 3, 2>> corners(options.vehicle_box_m.data());
    vehicle = Eigen::AlignedBox3f(Eigen::Vector3f(corners.col(0).cast<float>()),
                                  Eigen::Vector3f(corners.col(1).cast<float>()));
  }
}

bool ScanProjection::liesOnItsSide() const {
  return std::abs(R_level_lidar(2, 2)) < static_cast<float>(std::cos(radiansFromDegrees(kGreatestLeanDeg)));
}

}  // namespace saw_ndt::internal
