#include "report/pcl_ndt_localizer.h"

#include <pcl/filters/voxel_grid.h>
#include <pcl/registration/ndt.h>

#include <chrono>
#include <stdexcept>
#include <utility>

#include "common/threads.h"
#include "saw_ndt/common/error.h"

// PCL's library has it compiled; instantiated anew it would be held to this project's warnings.
extern template class pcl::NormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ>;

namespace saw_ndt {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using Clock = std::chrono::steady_clock;

constexpr double kTransformationEpsilon = 1e-4;

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

Cloud::Ptr finitePoints(const ScanView& scan, const Eigen::Isometry3f& T) {
  auto cloud = pcl::make_shared<Cloud>();
  cloud->reserve(scan.size);
  for (std::size_t i = 0; i < scan.size; ++i) {
    const Eigen::Vector3f point = T * Eigen::Map<const Eigen::Vector3f>(scan.point(i));
    if (point.allFinite()) cloud->emplace_back(point.x(), point.y(), point.z());
  }
  return cloud;
}

Cloud::Ptr thinned(const Cloud::ConstPtr& cloud, double voxel_size_m) {
  auto result = pcl::make_shared<Cloud>();
  pcl::VoxelGrid<pcl::PointXYZ> filter;
  filter.setLeafSize(Eigen::Vector4f::Constant(static_cast<float>(voxel_size_m)));
  filter.setInputCloud(cloud);
  filter.filter(*result);
  return result;
}

SourcePoints sourceOf(const Cloud& cloud) {
  SourcePoints source;
  source.reserve(cloud.size());
  for (const pcl::PointXYZ& point : cloud) source.add(point.x, point.y, point.z, StructuralLabel::NonGround);
  return source;
}

}  // namespace

class PclNdtLocalizer::Registration {
 public:
  Registration(const Cloud::ConstPtr& target, double resolution_m) {
    ndt_.setTransformationEpsilon(kTransformationEpsilon);
    ndt_.setResolution(static_cast<float>(resolution_m));
    // The tree over all target points, which NDT does not look into, would take as long as many alignments to build.
    ndt_.setSearchMethodTarget(pcl::make_shared<pcl::search::KdTree<pcl::PointXYZ>>(), true);
    ndt_.setInputTarget(target);
  }

  AlignmentResult align(const Cloud::ConstPtr& source, const Eigen::Isometry3d& T_start) {
    AlignmentResult result;
    result.T_map_source = T_start;
    if (source->empty()) return result;
    ndt_.setInputSource(source);
    Cloud aligned;
    ndt_.align(aligned, T_start.matrix().cast<float>());
    const Eigen::Matrix4d T = ndt_.getFinalTransformation().cast<double>();
    const bool converged = ndt_.hasConverged() && T.allFinite();
    if (T.allFinite()) result.T_map_source = normalizedRotation(Eigen::Isometry3d(T));
    result.status = converged ? AlignmentStatus::CONVERGED : AlignmentStatus::ITERATION_LIMIT;
    result.iterations = ndt_.getFinalNumIteration();
    result.likelihood = ndt_.getTransformationLikelihood();
    result.score = result.likelihood * static_cast<double>(source->size());
    return result;
  }

 private:
  pcl::NormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ> ndt_;
};

PclNdtLocalizer::PclNdtLocalizer(const Cloud::ConstPtr& target, double resolution_m, NdtTarget judge,
                                 const LocalizerOptions& options)
    : judge_(std::move(judge)), options_((options.check(), options)), prediction_(options.prediction) {
  if (!target) throw std::invalid_argument("PclNdtLocalizer: the target is a null pointer");
  checkOption(resolution_m > 0.0, "resolution_m", resolution_m, "positive");
  options_.acceptance.min_likelihood = 0.0;
  registration_ = std::make_unique<Registration>(target, resolution_m);
}

PclNdtLocalizer::~PclNdtLocalizer() = default;

void PclNdtLocalizer::setInitialPose(const Eigen::Isometry3d& T_map_base) { prediction_.reset(T_map_base); }

LocalizationResult PclNdtLocalizer::localize(const ScanView& scan, double stamp_s) {
  const Clock::time_point start = Clock::now();
  LocalizationResult result;
  result.stamp_s = stamp_s;
  result.T_map_base_predicted = prediction_.predict(stamp_s);
  Cloud::Ptr source = finitePoints(scan, options_.T_base_lidar.cast<float>());
  if (options_.source_voxel_size_m > 0.0) source = thinned(source, options_.source_voxel_size_m);
  result.source_points = source->size();
  result.times.filter_ms = millisecondsSince(start);

  const Clock::time_point alignment_start = Clock::now();
  result.alignment = registration_->align(source, result.T_map_base_predicted);
  result.times.align_ms = millisecondsSince(alignment_start);
  result.times.total_ms = millisecondsSince(start);

  result.likelihoods = evaluateLikelihoods(judge_.fine(), sourceOf(*source), result.alignment.T_map_source,
                                           AlignmentOptions().outlier_ratio, threadCount(options_.alignment.threads));
  concludeLocalization(result, options_.acceptance, prediction_);
  return result;
}

Cloud::Ptr mapPoints(const KittiSequence& sequence, const std::vector<int>& scans,
                     const std::function<void()>& scan_done) {
  const std::vector<Eigen::Isometry3d> poses = sequence.posesLidar();
  auto points = pcl::make_shared<Cloud>();
  for (const int scan : scans) {
    const Eigen::Isometry3d& T_map_lidar = poses[static_cast<std::size_t>(scan)];
    for (const pcl::PointXYZI& point : sequence.readScan(scan)) {
      const Eigen::Vector3f moved = (T_map_lidar * point.getVector3fMap().cast<double>()).cast<float>();
      if (moved.allFinite()) points->emplace_back(moved.x(), moved.y(), moved.z());
    }
    if (scan_done) scan_done();
  }
  return points;
}

}  // namespace saw_ndt
