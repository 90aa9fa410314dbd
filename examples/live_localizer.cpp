// Follows a vehicle through a map as scans come in: live_localizer MAP SCAN.bin...
#include <iostream>

#include "replayed_sensor.h"
#include "saw_ndt/localization/localizer.h"
#include "saw_ndt/pcl/cloud_view.h"

void publish(const saw_ndt::LocalizationResult& result) {
  std::cout << result.stamp_s << " s: " << toString(result.track.status) << ", position "
            << result.T_map_base.translation().transpose() << " m, heading " << saw_ndt::heading(result.T_map_base)
            << " rad, sigma " << result.covariance.diagonal().cwiseSqrt().transpose() << " (m, rad)\n";
}

int main(int argc, char** argv) try {
  if (argc < 3) throw std::invalid_argument("usage: live_localizer MAP SCAN.bin...");
  saw_ndt::LocalizerOptions options;
  options.segmentation.sensor = saw_ndt::SensorModel::named("VLP-16");
  saw_ndt::Localizer localizer(std::string(argv[1]), options);
  localizer.setInitialPose(Eigen::Isometry3d::Identity());  // where the vehicle starts in the map

  ReplayedSensor sensor({argv + 2, argv + argc});
  pcl::PointCloud<VelodynePoint> cloud;     // what a driver based on PCL hands over
  std::vector<saw_ndt::LidarPoint> points;  // or plain arrays: x y z intensity, point after point
  double stamp_s = 0.0;
  while (sensor.nextCloud(cloud, stamp_s)) {
    publish(localizer.localize(saw_ndt::viewOf(cloud), stamp_s));
    if (sensor.nextArray(points, stamp_s)) publish(localizer.localize(saw_ndt::viewOf(points), stamp_s));
  }
  return 0;
} catch (const std::exception& error) {
  std::cerr << "live_localizer: " << error.what() << '\n';
  return 1;
}
