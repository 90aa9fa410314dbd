#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "saw_ndt/common/scan_view.h"
#include "simulation/lidar_options.h"
#include "simulation/scene.h"
#include "simulation/vehicle_motion.h"

namespace saw_ndt {

/// One turn of a LiDAR. Points come ring after ring, the top ring first, azimuth rising from 0 to 360 degrees within a
/// ring, as in KITTI's files.
struct LidarScan {
  std::vector<LidarPoint> points;               ///< metres, LiDAR frame; intensity: reflectance, 0 to 0.99
  std::vector<std::uint16_t> semantic_classes;  ///< of SemanticKITTI, one a point
  std::vector<std::uint16_t> rings;             ///< beam of each point, 0 at the top
};

/// A spinning LiDAR on a vehicle that drives through a scene.
///
/// It turns counter-clockwise seen from above and looks forward at the stamp of a scan: azimuths from -pi to pi are
/// fired from half a scan period before the stamp to half a period after it. What moves in the scene is seen where it
/// is at that time; see LidarOptions::rolling_shutter for the motion of the LiDAR itself. The poses of the motion are
/// those of the LiDAR as it is mounted: VehicleMotion::withMounting(). The same scene, options and motion give the same
/// bytes, for any number of threads.
class LidarSimulator {
 public:
  /// @param threads  that cast rays; 0: all cores
  /// @throws std::invalid_argument that names what is wrong in the scene (see RayCaster) or the options
  LidarSimulator(const Scene& scene, const LidarOptions& options, int threads = 0);
  ~LidarSimulator();
  LidarSimulator(const LidarSimulator&) = delete;
  LidarSimulator& operator=(const LidarSimulator&) = delete;

  const LidarOptions& options() const;

  /// Casts scan number `scan` of a motion. @throws std::out_of_range unless 0 <= scan < motion.scanCount(),
  /// std::invalid_argument where the motion has other than one pose a stamp, a pose or stamp that is not finite, or,
  /// with rolling_shutter, what VehicleMotion::poseAt() refuses
  LidarScan scan(const VehicleMotion& motion, int scan);

 private:
  class Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace saw_ndt
