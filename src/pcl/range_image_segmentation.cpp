#include "saw_ndt/pcl/impl/range_image_segmentation.hpp"

SAW_NDT_INSTANTIATE_RangeImageSegmentation(pcl::PointXYZ) SAW_NDT_INSTANTIATE_RangeImageSegmentation(pcl::PointXYZI)
    SAW_NDT_INSTANTIATE_RangeImageSegmentation(pcl::PointXYZL)
