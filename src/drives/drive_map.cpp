#include "saw_ndt/drives/drive_map.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>

#include "common/threads.h"
#include "saw_ndt/pcl/cloud_view.h"

namespace saw_ndt {
WeightedMapBuilder buildSequenceMap(const KittiSequence& sequence, const std::vector<int>& scans,
                                    const SequenceMapOptions& options, const std::function<void()>& scan_done) {
  if (options.segmentation) options.segmentation->check();
  const std::vector<Eigen::Isometry3d> poses = sequence.posesLidar();
  WeightedMapBuilder map(options.resolution_m, options.segmentation);
  // Threads read and segment scans. What takes memory, the sums, there is once, and a scan is added to it in a fraction
  // of the time that it takes to segment.
  const int thread_count = std::min(threadCount(options.threads), threadCount(0));
  const auto scan_count = static_cast<std::ptrdiff_t>(scans.size());
  std::mutex map_mutex;
  std::exception_ptr failure;
  std::atomic<std::ptrdiff_t> failed_scan{scan_count};
#pragma omp parallel num_threads(thread_count)
  {
    ScanSegmenter segmenter(options.segmentation.value_or(SegmentationOptions()));
    std::vector<StructuralLabel> labels;
#pragma omp for schedule(dynamic)
    for (std::ptrdiff_t i = 0; i < scan_count; ++i) {
      if (i > failed_scan) continue;
      try {
        const int scan = scans[static_cast<std::size_t>(i)];
        const pcl::PointCloud<pcl::PointXYZI> cloud = sequence.readScan(scan);
        const Eigen::Isometry3d& T_map_lidar = poses[static_cast<std::size_t>(scan)];
        if (options.segmentation) segmenter.segment(viewOf(cloud), labels);
        {
          const std::lock_guard<std::mutex> lock(map_mutex);
          map.addScan(viewOf(cloud), options.segmentation ? LabelView(labels) : LabelView(), T_map_lidar);
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
  }
  if (failure) std::rethrow_exception(failure);
  return map;
}

}  // namespace saw_ndt
