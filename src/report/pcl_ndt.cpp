#include "report/pcl_ndt.h"

#include <pcl/common/transforms.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/registration/ndt.h>

#include <stdexcept>

#include "registration/likelihoods.h"
#include "registration/ndt_derivatives.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"

// PCL's library has it compiled; instantiated anew it would be held to this project's warnings.
extern template class pcl::NormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ>;

namespace saw_ndt {

using namespace internal;

namespace {

constexpr double kTransformationEpsilon = 1e-4;
constexpr float kSourceVoxelSize_m = 0.2F;

PclNdt::Cloud::Ptr cloudOf(const SourcePoints& source) {
  auto cloud = pcl::make_shared<PclNdt::Cloud>();
  for (std::size_t i = 0; i < source.size(); ++i) cloud->emplace_back(source.x[i], source.y[i], source.z[i]);
  return cloud;
}

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

PclNdt::PclNdt(const Cloud::ConstPtr& target, double resolution_m) : registration_(std::make_unique<Registration>()) {
  if (!target) throw std::invalid_argument("PclNdt: the target is a null pointer");
  checkOption(resolution_m > 0.0, "resolution_m", resolution_m, "positive");
  registration_->setTransformationEpsilon(kTransformationEpsilon);
  registration_->setResolution(static_cast<float>(resolution_m));
  // The tree over all target points, which NDT does not look into, would take as long as many alignments to build.
  registration_->setSearchMethodTarget(pcl::make_shared<pcl::search::KdTree<pcl::PointXYZ>>(), true);
  registration_->setInputTarget(target);
}

PclNdt::~PclNdt() = default;
PclNdt::PclNdt(PclNdt&& other) noexcept = default;

PclNdt::Cloud::Ptr PclNdt::thinned(const Cloud::ConstPtr& scan) {
  auto result = pcl::make_shared<Cloud>();
  pcl::VoxelGrid<pcl::PointXYZ> filter;
  filter.setLeafSize(kSourceVoxelSize_m, kSourceVoxelSize_m, kSourceVoxelSize_m);
  filter.setInputCloud(scan);
  filter.filter(*result);
  return result;
}

void PclNdt::setSource(const Cloud::ConstPtr& source) { registration_->setInputSource(source); }

AlignmentResult PclNdt::align(const Eigen::Isometry3d& T_map_start) {
  Cloud aligned;
  registration_->align(aligned, T_map_start.matrix().cast<float>());
  AlignmentResult result;
  result.T_map_source = T_map_start;
  const Eigen::Matrix4d T = registration_->getFinalTransformation().cast<double>();
  const bool converged = registration_->hasConverged() && T.allFinite();
  if (T.allFinite()) result.T_map_source = normalizedRotation(Eigen::Isometry3d(T));
  result.status = converged ? AlignmentStatus::CONVERGED : AlignmentStatus::ITERATION_LIMIT;
  result.iterations = registration_->getFinalNumIteration();
  result.likelihood = registration_->getTransformationLikelihood();
  result.score = result.likelihood * static_cast<double>(registration_->getInputSource()->size());
  return result;
}

double PclNdt::evaluate(const Eigen::Isometry3d& T_map_source) { return registration_->evaluate(T_map_source); }

std::size_t PclNdt::pairCount(const Eigen::Isometry3d& T_map_source) { return registration_->pairCount(T_map_source); }

SourceAligner pclNdtAligner(const PclNdt::Cloud::ConstPtr& target, double resolution_m, const NdtTarget& judge) {
  // A std::function must be copyable.
  auto ndt = std::make_shared<PclNdt>(target, resolution_m);
  return [ndt, judge](const SourcePoints& source, const Eigen::Isometry3d& T_map_base_predicted) {
    AlignmentResult result;
    result.T_map_source = T_map_base_predicted;
    if (source.empty()) return result;
    ndt->setSource(cloudOf(source));
    result = ndt->align(T_map_base_predicted);
    result.likelihoods =
        evaluateLikelihoods(judge.fine(), source, result.T_map_source, AlignmentOptions().outlier_ratio, 1);
    return result;
  };
}

PclNdt::Cloud::Ptr mapPoints(ScanSource& scans, const std::function<void()>& scan_done) {
  auto points = pcl::make_shared<PclNdt::Cloud>();
  RecordedScan scan;
  while (scans.next(scan)) {
    if (!scan.failure.empty()) throw Error(scan.failure);
    if (!scan.T_map_lidar) throw Error(scan.name, "", "has no reference pose");
    for (const LidarPoint& point : scan.points) {
      const Eigen::Vector3f moved = (*scan.T_map_lidar * positionOf(point).cast<double>()).cast<float>();
      if (moved.allFinite()) points->emplace_back(moved.x(), moved.y(), moved.z());
    }
    if (scan_done) scan_done();
  }
  return points;
}

}  // namespace saw_ndt
