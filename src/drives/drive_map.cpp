#include "saw_ndt/drives/drive_map.h"

#include <cmath>
#include <exception>
#include <mutex>

#include "common/executor.h"
#include "drives/drive_plan.h"
#include "drives/reference_motion.h"
#include "localization/motion_compensation.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/drives/moved_removal.h"

namespace saw_ndt {

namespace {

/// Hands the scans of a source to several threads, until one of them is an error.
class SharedSource {
 public:
  SharedSource(ScanSource& scans, const std::function<void(const std::string&)>& left_out)
      : scans_(scans), left_out_(left_out) {}

  bool next(RecordedScan& scan) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (failure_) return false;
    while (scans_.next(scan)) {
      const std::string reason = failureOf(scan);
      if (reason.empty()) return true;
      if (!left_out_) {
        // Scans come in order, so that this is the first bad one.
        failure_ = std::make_exception_ptr(Error(reason));
        return false;
      }
      left_out_(reason);
    }
    return false;
  }
  /// A scan that next() gave is an error.
  void fail(const Error& error) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!failure_) failure_ = std::make_exception_ptr(error);
  }
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  static std::string failureOf(const RecordedScan& scan) {
    if (!scan.failure.empty() || scan.T_map_lidar) return scan.failure;
    return scan.name + ": has no reference pose, which a map is built by";
  }

  ScanSource& scans_;
  const std::function<void(const std::string&)>& left_out_;
  std::mutex mutex_;
  std::exception_ptr failure_;
};

// The scan as seen at its stamp. @throws Error where that is not known
ScanView compensated(const RecordedScan& scan, const DriveMapOptions& options, std::vector<LidarPoint>& moved) {
  const auto motion = internal::motionAt(options.trajectory, scan.stamp_s);
  if (!motion) throw Error(scan.name, "", "its motion, to be taken out, is not known: no poses close in time");
  if (!internal::compensateScan(viewOf(scan), options.motion_compensation, {scan.stamp_s, options.scan_period_s},
                                *motion, moved)) {
    throw Error(scan.name, "", "its points have no times of measurement to take the motion out by");
  }
  return viewOf(moved);
}

// Hands the scans of a source to several threads, each of which has a worker of its own:
// worker(scan as measured, scan as seen at its stamp, T_map_lidar).
template <typename MakeWorker>
void forEachScan(ScanSource& scans, const DriveMapOptions& options, const std::function<void()>& scan_done,
                 const MakeWorker& makeWorker) {
  options.check();
  SharedSource source(scans, options.scan_left_out);
  const int threads = internal::threadCount(options.threads);
  internal::forEachChunkOffline(threads, static_cast<std::size_t>(threads), [&](std::size_t, int) {
    auto worker = makeWorker();
    std::vector<LidarPoint> points;
    RecordedScan scan;
    while (source.next(scan)) {
      ScanView view = viewOf(scan);
      if (options.motion_compensation != MotionCompensation::OFF) {
        try {
          view = compensated(scan, options, points);
        } catch (const Error& error) {
          source.fail(error);
          return;
        }
      }
      worker(viewOf(scan), view, *scan.T_map_lidar);
      if (scan_done) scan_done();
    }
  });
  source.rethrow();
}

}  // namespace

void DriveMapOptions::check() const {
  if (segmentation) segmentation->check();
  checkOption(scan_period_s > 0.0 && std::isfinite(scan_period_s), "scan_period_s", scan_period_s, "positive");
}

void addScans(ScanSource& scans, const DriveMapOptions& options, MovedVoxels& moved,
              const std::function<void()>& scan_done) {
  forEachScan(scans, options, scan_done, [&moved] {
    return [&moved](const ScanView&, const ScanView& scan, const Eigen::Isometry3d& T_map_lidar) {
      moved.addScan(scan, T_map_lidar);
    };
  });
}

WeightedMapBuilder buildDriveMap(ScanSource& scans, const DriveMapOptions& options,
                                 const std::function<void()>& scan_done) {
  WeightedMapBuilder map(options.resolution_m, options.segmentation);
  std::string last_failure;
  addScans(scans, internal::notingFailures(options, last_failure), map, scan_done);
  internal::requireAnyPoint(map.origin(), last_failure);
  return map;
}

void addScans(ScanSource& scans, const DriveMapOptions& options, WeightedMapBuilder& map,
              const std::function<void()>& scan_done) {
  // What takes memory, the sums, there is once, and a scan is added to it in a fraction of the time that it takes to
  // segment.
  std::mutex map_mutex;
  forEachScan(scans, options, scan_done, [&] {
    return [&, segmenter = ScanSegmenter(options.segmentation.value_or(SegmentationOptions())),
            labels = std::vector<StructuralLabel>()](const ScanView& measured, const ScanView& scan,
                                                     const Eigen::Isometry3d& T_map_lidar) mutable {
      if (options.segmentation) segmenter.segment(measured, labels);
      const std::lock_guard<std::mutex> lock(map_mutex);
      map.addScan(scan, options.segmentation ? LabelView(labels) : LabelView(), T_map_lidar);
    };
  });
}

}  // namespace saw_ndt
