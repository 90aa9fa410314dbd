#include "pcl_ndt.h"

#include <pcl/common/transforms.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/registration/ndt.h>

#include "saw_ndt/common/geometry.h"
#include "registration/ndt_derivatives.h"

// PCL's library has it compiled; instantiated anew it would be held to this project's warnings.
extern template class pcl::NormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ>;

namespace saw_ndt {
namespace {

constexpr double kTransformationEpsilon = 1e-4;
constexpr float kSourceVoxelSize_m = 0.2f;

}  // namespace

class PclNdt::Registration : public pcl::NormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ> {
 public:
  double evaluate(const Eigen::Isometry3d& T) {
    point_jacobian_.setZero();
    point_jacobian_.block<3, 3>(0, 0).setIdentity();
    point_hessian_.setZero();
    pcl::transformPointCloud(*input_, moved_, T.matrix().cast<float>());
    Vector6d pose, gradient;
    pose << T.translation(), eulerFromRotation(T.linear());
    Matrix6d hessian;
    return computeDerivatives(gradient, hessian, moved_, pose);
  }

  std::size_t pairCount(const Eigen::Isometry3d& T) {
    pcl::transformPointCloud(*input_, moved_, T.matrix().cast<float>());
    std::size_t count = 0;
    std::vector<TargetGridLeafConstPtr> neighbours;
    std::vector<float> distances;
    for (const pcl::PointXYZ& point : moved_) {
      target_cells_.radiusSearch(point, resolution_, neighbours, distances);
      count += neighbours.size();
    }
    return count;
  }

 private:
  Cloud moved_;
};

PclNdt::PclNdt(const Cloud::ConstPtr& target) : registration_(std::make_unique<Registration>()) {
  registration_->setTransformationEpsilon(kTransformationEpsilon);
  // The tree over all target points, which NDT does not look into, would take as long as many alignments to build.
  registration_->setSearchMethodTarget(pcl::make_shared<pcl::search::KdTree<pcl::PointXYZ>>(), true);
  registration_->setInputTarget(target);
}

PclNdt::~PclNdt() = default;

PclNdt::Cloud::Ptr PclNdt::thinned(const Cloud::ConstPtr& scan) {
  auto result = pcl::make_shared<Cloud>();
  pcl::VoxelGrid<pcl::PointXYZ> filter;
  filter.setLeafSize(kSourceVoxelSize_m, kSourceVoxelSize_m, kSourceVoxelSize_m);
  filter.setInputCloud(scan);
  filter.filter(*result);
  return result;
}

void PclNdt::setSource(const Cloud::ConstPtr& source) { registration_->setInputSource(source); }

int PclNdt::align(const Eigen::Isometry3d& T_start) {
  Cloud aligned;
  registration_->align(aligned, T_start.matrix().cast<float>());
  return registration_->getFinalNumIteration();
}

double PclNdt::evaluate(const Eigen::Isometry3d& T_map_source) { return registration_->evaluate(T_map_source); }

std::size_t PclNdt::pairCount(const Eigen::Isometry3d& T_map_source) { return registration_->pairCount(T_map_source); }

}  // namespace saw_ndt
