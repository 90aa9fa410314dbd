#include <gtest/gtest.h>

#include <string>

#include "localization/synthetic_drive.h"
#include "saw_ndt/pcl/weighted_normal_distributions_transform.h"

namespace saw_ndt {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using Ndt = WeightedNormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ, double>;

/// The points of a scan moved by T, in single precision as PCL has them.
Cloud::Ptr moved(const std::vector<LidarPoint>& scan, const Eigen::Isometry3d& T) {
  auto cloud = pcl::make_shared<Cloud>();
  for (const LidarPoint& point : scan) {
    const Eigen::Vector3f p = (T * Eigen::Vector3d(point.x, point.y, point.z)).cast<float>();
    cloud->push_back({p.x(), p.y(), p.z()});
  }
  return cloud;
}

Eigen::Isometry3d translation(const Eigen::Vector3d& t) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = t;
  return T;
}

/// Two scans of the street, half a metre and 2 degrees apart, in coordinates whose origin is far away: that of the
/// source alone, or of both. About that origin, a turn of 2 degrees would be a way of kilometres.
class FarCoordinates : public ::testing::TestWithParam<bool> {
 protected:
  FarCoordinates() {
    SensorModel sensor = SensorModel::named("HDL-64E");
    sensor.columns = 1000;
    const Eigen::Isometry3d T_ground_lidar = translation({-5.0, -2.0, 1.73});
    target = scanBlocks(streetBlocks(), sensor, T_ground_lidar, 1);
    source = scanBlocks(streetBlocks(), sensor, T_ground_lidar, 2);
    T_target_source.translation() << 0.5, -0.3, 0.0;
    T_target_source.linear() = rotationFromVector({0.0, 0.0, radiansFromDegrees(2.0)});
  }

  /// With the origins of the scans at these places. The pose is told between the scans' own frames.
  AlignmentResult align(const Eigen::Vector3d& target_origin, const Eigen::Vector3d& source_origin) const {
    Ndt ndt;
    ndt.setInputTarget(moved(target, translation(target_origin)));
    ndt.setInputSource(moved(source, translation(source_origin) * T_target_source.inverse()));
    Cloud output;
    ndt.align(output, translation(target_origin - source_origin).matrix());
    AlignmentResult result = ndt.getAlignmentResult();
    result.T_map_source = translation(-target_origin) * result.T_map_source * translation(source_origin);
    return result;
  }

  static double metres(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
    return (a.translation() - b.translation()).norm();
  }
  static double degrees(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
    return degreesFromRadians(rotationAngle(a.linear().transpose() * b.linear()));
  }

  std::vector<LidarPoint> target, source;
  Eigen::Isometry3d T_target_source = Eigen::Isometry3d::Identity();
};

TEST_P(FarCoordinates, CostNothingButWhatSinglePrecisionRoundsAway) {
  const struct {
    std::string name;
    Eigen::Vector3d origin_m;
    double max_error_m, max_error_deg;
    int max_more_evaluations;  ///< than near the origin
  } cases[] = {
      // Coordinates in steps of 0.1, 1 and 8 mm: less than the noise of 1 cm.
      {"a kilometre", {1e3, 1e3, 0.0}, 0.005, 0.01, 2},
      {"ten kilometres", {1e4, 1e4, 0.0}, 0.005, 0.01, 2},
      {"MGRS", {1e5, 1e5, 40.0}, 0.005, 0.01, 2},
      // Steps of 0.25 and 0.5 m, which leave no surface smooth. The pose is right to half a step all the same.
      {"UTM", {388096.0, 3948996.0, 40.0}, 0.125, 0.3, 6},
      {"UTM in the north", {5e5, 5e6, 120.0}, 0.25, 0.3, 20},
  };
  const Eigen::Vector3d here = Eigen::Vector3d::Zero();
  const AlignmentResult near_result = align(here, here);
  EXPECT_LT(metres(near_result.T_map_source, T_target_source), 0.005);
  for (const auto& c : cases) {
    SCOPED_TRACE(c.name);
    const AlignmentResult result = align(GetParam() ? c.origin_m : here, c.origin_m);
    EXPECT_TRUE(result.converged()) << toString(result.status);
    EXPECT_LT(metres(result.T_map_source, T_target_source), c.max_error_m);
    EXPECT_LT(degrees(result.T_map_source, T_target_source), c.max_error_deg);
    EXPECT_LE(result.evaluations, near_result.evaluations + c.max_more_evaluations);
  }
}

INSTANTIATE_TEST_SUITE_P(OfTheTargetToo, FarCoordinates, testing::Bool());

}  // namespace
}  // namespace saw_ndt
