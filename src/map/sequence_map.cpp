#include "saw_ndt/map/sequence_map.h"

#include <atomic>
#include <exception>

#include "saw_ndt/common/threads.h"
#include "saw_ndt/segmentation/cloud_view.h"

namespace saw_ndt {
namespace {

pcl::PointCloud<pcl::PointXYZL> withLabels(const pcl::PointCloud<pcl::PointXYZI>& scan,
                                           const std::vector<StructuralLabel>& labels) {
  pcl::PointCloud<pcl::PointXYZL> labelled;
  labelled.resize(scan.size());
  for (std::size_t i = 0; i < scan.size(); ++i) {
    labelled[i].getVector3fMap() = scan[i].getVector3fMap();
    labelled[i].label = static_cast<std::uint32_t>(labels[i]);
  }
  return labelled;
}

}  // namespace

WeightedMapBuilder buildSequenceMap(const KittiSequence& sequence, const std::vector<int>& scans,
                                    const SequenceMapOptions& options, const std::function<void()>& scan_done) {
  if (options.segmentation) options.segmentation->check();
  const std::vector<Eigen::Isometry3d> poses = sequence.posesLidar();
  WeightedMapBuilder map(options.resolution_m);
  const auto scan_count = static_cast<std::ptrdiff_t>(scans.size());
  std::exception_ptr failure;
  std::atomic<std::ptrdiff_t> failed_scan{scan_count};
#pragma omp parallel num_threads(threadCount(options.threads))
  {
    WeightedMapBuilder part(options.resolution_m);
    ScanSegmenter segmenter(options.segmentation.value_or(SegmentationOptions()));
    std::vector<StructuralLabel> labels;
#pragma omp for schedule(dynamic)
    for (std::ptrdiff_t i = 0; i < scan_count; ++i) {
      if (i > failed_scan) continue;
      try {
        const int scan = scans[static_cast<std::size_t>(i)];
        const pcl::PointCloud<pcl::PointXYZI> cloud = sequence.readScan(scan);
        const Eigen::Isometry3d& T_map_lidar = poses[static_cast<std::size_t>(scan)];
        if (options.segmentation) {
          segmenter.segment(viewOf(cloud), labels);
          part.addCloud(withLabels(cloud, labels), T_map_lidar);
        } else {
          part.addCloud(cloud, T_map_lidar);
        }
        if (scan_done) scan_done();
      } catch (...) {
        // The first scan's error is reported, whichever thread met it.
#pragma omp critical
        if (i < failed_scan) {
          failed_scan = i;
          failure = std::current_exception();
        }
      }
    }
#pragma omp critical
    map.merge(part);
  }
  if (failure) std::rethrow_exception(failure);
  return map;
}

}  // namespace saw_ndt
