#include "saw_ndt/pcl/weighted_normal_distributions_transform.h"

namespace saw_ndt {

template class WeightedNormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ, float>;
template class WeightedNormalDistributionsTransform<pcl::PointXYZI, pcl::PointXYZI, float>;
template class WeightedNormalDistributionsTransform<pcl::PointXYZL, pcl::PointXYZL, float>;
template class WeightedNormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ, double>;
template class WeightedNormalDistributionsTransform<pcl::PointXYZI, pcl::PointXYZI, double>;
template class WeightedNormalDistributionsTransform<pcl::PointXYZL, pcl::PointXYZL, double>;

}  // namespace saw_ndt
