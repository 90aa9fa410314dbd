#include "saw_ndt/pcl/ground_subsampling.h"

#include <pcl/point_types.h>

#include "saw_ndt/pcl/impl/ground_subsampling.hpp"

SAW_NDT_INSTANTIATE_GroundSubsampling(pcl::PointXYZ) SAW_NDT_INSTANTIATE_GroundSubsampling(pcl::PointXYZI)
    SAW_NDT_INSTANTIATE_GroundSubsampling(pcl::PointXYZL)
