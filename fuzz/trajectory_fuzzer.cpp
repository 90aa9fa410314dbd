// Poses in TUM, KITTI and CSV format, and the files of odometry and positions, which are of these formats as well.
#include "drives/prior_sources.h"
#include "fuzzed_file.h"
#include "saw_ndt/io/trajectory.h"

namespace saw_ndt {
namespace {

/// A few scans without points at the stamps of a short drive.
class EmptyScans : public ScanSource {
 public:
  bool next(RecordedScan& scan) override {
    if (number_ == 4) return false;
    scan = RecordedScan();
    scan.stamp_s = 0.5 * number_++;
    return true;
  }
  std::optional<std::size_t> scanCount() const override { return 4; }

 private:
  int number_ = 0;
};

void requireFinite(ScanSource& scans) {
  RecordedScan scan;
  while (scans.next(scan)) {
    const std::optional<MeasuredMotion>& motion = scan.priors.motion;
    const std::optional<MeasuredPosition>& position = scan.priors.position;
    require(!motion || (motion->T_before_now.matrix().allFinite() && motion->covariance.allFinite()),
            "odometry is finite");
    require(!position || (position->position_m.allFinite() && position->covariance.allFinite()),
            "positions are finite");
  }
}

}  // namespace
}  // namespace saw_ndt

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static saw_ndt::FuzzedFile file("poses.txt");
  file.tryReading(data, size, [](const std::filesystem::path& path) {
    for (const saw_ndt::StampedPose& pose : saw_ndt::readTrajectory(path).poses) {
      const Eigen::Matrix3d R = pose.T_map_body.linear();
      saw_ndt::require(pose.T_map_body.matrix().allFinite() && (R * R.transpose()).isIdentity(1e-9), "poses are rigid");
    }
  });
  file.tryReading(data, size, [](const std::filesystem::path& path) {
    saw_ndt::requireFinite(*saw_ndt::withOdometry(std::make_unique<saw_ndt::EmptyScans>(), path, {}));
  });
  file.tryReading(data, size, [](const std::filesystem::path& path) {
    saw_ndt::requireFinite(*saw_ndt::withPositions(std::make_unique<saw_ndt::EmptyScans>(), path, 0.1));
  });
  return 0;
}
