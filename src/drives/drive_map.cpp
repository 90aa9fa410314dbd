#include "saw_ndt/drives/drive_map.h"

#include <atomic>
#include <exception>

#include "common/threads.h"
#include "saw_ndt/pcl/cloud_view.h"

namespace saw_ndt {
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
          part.addScan(viewOf(cloud), LabelView(labels), T_map_lidar);
        } else {
          part.addScan(viewOf(cloud), {}, T_map_lidar);
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
