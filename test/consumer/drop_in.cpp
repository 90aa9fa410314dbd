#include <pcl/common/transforms.h>

#include <cmath>
#include <iostream>

#include "saw_ndt/drives/scan_selection.h"
#include "saw_ndt/evaluation/metrics.h"
#include "saw_ndt/pcl/range_image_segmentation.h"
#include "saw_ndt/pcl/weighted_normal_distributions_transform.h"

// Aligns a room's corner with a copy of itself that was moved by 12 cm. Exit code 0: found to within 5 mm.
int main() {
  using Cloud = pcl::PointCloud<pcl::PointXYZ>;
  const auto target = pcl::make_shared<Cloud>();
  for (int i = 0; i < 60; ++i) {
    for (int j = 0; j < 60; ++j) {
      const float a = 0.1f * static_cast<float>(i), b = 0.1f * static_cast<float>(j);
      target->push_back({a, b, 0.02f * std::sin(3.0f * a)});
      target->push_back({a, 0.02f * std::sin(3.0f * b), b});
      target->push_back({0.02f * std::sin(3.0f * a), a, b});
    }
  }
  Eigen::Affine3f T_target_source(Eigen::Translation3f(0.1f, -0.05f, 0.05f));
  const auto source = pcl::make_shared<Cloud>();
  pcl::transformPointCloud(*target, *source, T_target_source.inverse());

  saw_ndt::WeightedNormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ> ndt;
  ndt.setInputTarget(target);
  ndt.setInputSource(source);
  Cloud aligned;
  ndt.align(aligned);

  const Eigen::Isometry3d T_expected(T_target_source.matrix().cast<double>());
  const Eigen::Isometry3d T_found(ndt.getFinalTransformation().cast<double>());
  const saw_ndt::PoseError error = saw_ndt::poseError(T_expected, T_found);
  std::cout << "converged " << ndt.hasConverged() << ", error " << error.position_m << " m, scans selected "
            << saw_ndt::parseScanSelection("0:10:2", 10).size() << '\n';
  return ndt.hasConverged() && error.position_m < 5e-3 ? 0 : 1;
}
