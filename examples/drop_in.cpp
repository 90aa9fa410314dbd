// Registers one cloud to another. The program it was with pcl::NormalDistributionsTransform, which -DUSE_PCL_NDT still
// builds, differs in one include and one type.
#include <pcl/io/pcd_io.h>
#include <pcl/point_types.h>

#include <iostream>

#ifdef USE_PCL_NDT
#include <pcl/registration/ndt.h>
using Ndt = pcl::NormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ>;
#else
#include "saw_ndt/pcl/weighted_normal_distributions_transform.h"
using Ndt = saw_ndt::WeightedNormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ>;
#endif

int main(int argc, char** argv) {
  const auto source = pcl::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  const auto target = pcl::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  if (argc != 3 || pcl::io::loadPCDFile(argv[1], *source) < 0 || pcl::io::loadPCDFile(argv[2], *target) < 0) {
    std::cerr << "Usage: drop_in SOURCE.pcd TARGET.pcd\n";
    return 2;
  }

  Ndt ndt;
  ndt.setResolution(1.0f);
  ndt.setTransformationEpsilon(1e-6);
  ndt.setMaximumIterations(50);
  ndt.setInputTarget(target);
  ndt.setInputSource(source);
  pcl::PointCloud<pcl::PointXYZ> aligned;
  ndt.align(aligned);
  std::cout << ndt.getFinalTransformation() << '\n';
  return ndt.hasConverged() ? 0 : 1;
}
