#pragma once

#include <pcl/point_types.h>
#include <pcl/registration/ndt.h>

// PCL's library has it compiled; instantiated anew it would be held to this project's warnings.
extern template class pcl::NormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ>;
