#include <cmath>
#include <iostream>
#include <vector>

#include "saw_ndt/localization/localizer.h"
#include "saw_ndt/map/weighted_map_builder.h"
#include "saw_ndt/version.h"

// Localizes a scan of a room's corner in a map of that corner, with the core library alone. Exit code 0: found to
// within 5 mm.
int main() {
  std::vector<saw_ndt::LidarPoint> corner, scan;
  const Eigen::Vector3f T_map_scan(0.1F, -0.05F, 0.05F);
  for (int i = 0; i < 60; ++i) {
    for (int j = 0; j < 60; ++j) {
      const float a = 0.1F * static_cast<float>(i), b = 0.1F * static_cast<float>(j);
      corner.push_back({a, b, 0.02F * std::sin(3.0F * a), 0.0F});
      corner.push_back({a, 0.02F * std::sin(3.0F * b), b, 0.0F});
      corner.push_back({0.02F * std::sin(3.0F * a), a, b, 0.0F});
    }
  }
  for (saw_ndt::LidarPoint point : corner) {
    saw_ndt::positionOf(point) -= T_map_scan;
    scan.push_back(point);
  }
  saw_ndt::WeightedMapBuilder builder(1.0);
  builder.addScan(saw_ndt::viewOf(corner), {}, Eigen::Isometry3d::Identity());
  saw_ndt::LocalizerOptions options;
  options.method = saw_ndt::LocalizationMethod::named("classical");
  options.source_voxel_size_m = 0.0;  // every point
  saw_ndt::Localizer localizer(builder.build(), options);
  localizer.setInitialPose(Eigen::Isometry3d::Identity());
  const saw_ndt::LocalizationResult result = localizer.localize(saw_ndt::viewOf(scan), 0.0);

  const double error_m = (result.T_map_base.translation() - T_map_scan.cast<double>()).norm();
  std::cout << "saw_ndt " << SAW_NDT_VERSION << ": " << toString(result.acceptance) << ", error " << error_m << " m\n";
  return result.accepted() && error_m < 5e-3 ? 0 : 1;
}
