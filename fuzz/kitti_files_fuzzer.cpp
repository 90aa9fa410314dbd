// The text files of KITTI beside trajectories: calibrations, GPS/IMU records, stamps. And labels.
#include "fuzzed_file.h"
#include "io/kitti_oxts.h"
#include "saw_ndt/io/kitti.h"
#include "saw_ndt/io/trajectory.h"

using saw_ndt::FuzzedFile;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static FuzzedFile file("calib.txt");
  if (size == 0) return 0;
  const std::uint8_t* rest = data + 1;
  file.tryReading(rest, size - 1, [&](const std::filesystem::path& path) {
    switch (data[0] % 5) {
      case 0:
        saw_ndt::readKittiCalibration(path);
        break;
      case 1:
        saw_ndt::internal::readKittiRawTransform(path);
        break;
      case 2:
        for (const Eigen::Isometry3d& T : saw_ndt::internal::imuPoses(saw_ndt::internal::readOxts(path))) {
          saw_ndt::require(T.matrix().allFinite(), "poses are finite");
        }
        break;
      case 3:
        saw_ndt::readStamps(path);
        break;
      default:
        saw_ndt::readSemanticKittiLabels(path);
    }
  });
  return 0;
}
