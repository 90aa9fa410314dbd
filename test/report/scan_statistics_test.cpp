#include "report/scan_statistics.h"

#include <gtest/gtest.h>
#include <pcl/point_types.h>

#include <cmath>
#include <map>

#include "saw_ndt/common/geometry.h"
#include "saw_ndt/pcl/cloud_view.h"

namespace saw_ndt {
namespace {

/// A VLP-16 on a level plane 2 m below it, walled in 10 m away; one return a column.
pcl::PointCloud<pcl::PointXYZ> courtyard(const SensorModel& sensor) {
  pcl::PointCloud<pcl::PointXYZ> cloud;
  for (const double elevation_deg : sensor.elevations_deg) {
    for (int column = 0; column < sensor.columns; ++column) {
      const double azimuth = 2.0 * kPi * (column + 0.5) / sensor.columns;
      const double elevation = radiansFromDegrees(elevation_deg);
      const double level_m = elevation < 0.0 ? std::min(10.0, -2.0 / std::tan(elevation)) : 10.0;
      cloud.emplace_back(static_cast<float>(level_m * std::cos(azimuth)),
                         static_cast<float>(level_m * std::sin(azimuth)),
                         static_cast<float>(level_m * std::tan(elevation)));
    }
  }
  return cloud;
}

TEST(ScanStatistics, OfACourtyardAreThoseOfItsGeometry) {
  SegmentationOptions options;
  options.sensor = SensorModel::named("VLP-16");
  ScanSegmenter segmenter(options);
  const auto cloud = courtyard(options.sensor);
  std::vector<std::uint16_t> classes(cloud.size(), 50);
  std::size_t on_ground = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (cloud[i].z > -1.999f) continue;
    classes[i] = 40;
    ++on_ground;
  }
  std::map<std::string, double> figures;
  for (const auto& [name, value] : scanStatistics(viewOf(cloud), classes, segmenter)) figures[name] = value;
  EXPECT_EQ(figures.at("points"), 16.0 * 1800.0);
  for (int eighth = 1; eighth <= 8; ++eighth) {
    EXPECT_EQ(figures.at("points_a_ring_of_eighth_" + std::to_string(eighth)), 1800.0);
  }
  // Beams from -11 degrees on meet the ground, the nearest of them, at -15 degrees, after 2 m / sin(15 degrees).
  EXPECT_NEAR(figures.at("range_p5_m"), 2.0 / std::sin(radiansFromDegrees(15.0)), 1e-3);
  EXPECT_NEAR(figures.at("range_p95_m"), 10.0 / std::cos(radiansFromDegrees(15.0)), 1e-3);
  EXPECT_NEAR(figures.at("ground_class_share"), static_cast<double>(on_ground) / static_cast<double>(cloud.size()),
              1e-12);
  EXPECT_LT(figures.at("ground_thickness_p50_m"), 1e-3);
}

TEST(ScanStatistics, AnEmptyScanHasFiguresOfNothing) {
  ScanSegmenter segmenter;
  for (const auto& [name, value] : scanStatistics(ScanView(), {}, segmenter)) EXPECT_EQ(value, 0.0) << name;
}

}  // namespace
}  // namespace saw_ndt
