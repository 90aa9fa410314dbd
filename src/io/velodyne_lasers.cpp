#include "io/velodyne_lasers.h"

#include <pcl/io/vlp_grabber.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>

#include "io/velodyne_calibration.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt::internal {

class VelodyneLasers::Geometry {
 public:
  virtual ~Geometry() = default;

  virtual double elevation_deg(std::size_t laser) const = 0;
  /// @param azimuth  0.01 degrees, 0 to 36000
  virtual LidarPoint point(std::size_t laser, std::uint16_t azimuth, VelodyneReturn laser_return) const = 0;
};

/// One of PCL's grabbers that is never started: it opens neither a file nor a socket, and is asked for its geometry.
template <typename Grabber>
class VelodyneLasers::GrabberGeometry : public VelodyneLasers::Geometry, private Grabber {
 public:
  void setCorrection(std::size_t laser, const VelodyneCorrection& correction) {
    auto& pcl_correction = this->laser_corrections_[laser];
    pcl_correction = {};
    pcl_correction.azimuthCorrection = correction.azimuth_deg;
    pcl_correction.verticalCorrection = correction.elevation_deg;
    pcl_correction.distanceCorrection = correction.distance_m;
    pcl_correction.verticalOffsetCorrection = correction.vertical_offset_m;
    pcl_correction.horizontalOffsetCorrection = correction.horizontal_offset_m;
    pcl_correction.sinVertCorrection = std::sin(radiansFromDegrees(correction.elevation_deg));
    pcl_correction.cosVertCorrection = std::cos(radiansFromDegrees(correction.elevation_deg));
  }

  double elevation_deg(std::size_t laser) const override { return this->laser_corrections_[laser].verticalCorrection; }

  LidarPoint point(std::size_t laser, std::uint16_t azimuth, VelodyneReturn laser_return) const override {
    pcl::PointXYZI of_velodyne;
    this->computeXYZI(of_velodyne, azimuth, {laser_return.distance, laser_return.intensity},
                      this->laser_corrections_[laser]);
    return {of_velodyne.y, -of_velodyne.x, of_velodyne.z, of_velodyne.intensity};
  }
};

VelodyneLasers::VelodyneLasers(VelodyneModel model, const std::filesystem::path& calibration) : model_(model) {
  // The first grabber of the process fills tables that all of them share.
  static std::mutex tables;
  if (model == VelodyneModel::HDL_64E) {
    if (calibration.empty()) throw Error("an HDL-64E cannot be read without its calibration (db.xml)");
    const auto corrections = readVelodyneCalibration(calibration);
    const std::lock_guard<std::mutex> lock(tables);
    auto geometry = std::make_unique<GrabberGeometry<pcl::HDLGrabber>>();
    for (std::size_t laser = 0; laser < corrections.size(); ++laser) {
      geometry->setCorrection(laser, corrections[laser]);
    }
    geometry_ = std::move(geometry);
  } else {
    const std::lock_guard<std::mutex> lock(tables);
    if (model == VelodyneModel::HDL_32E) {
      geometry_ = std::make_unique<GrabberGeometry<pcl::HDLGrabber>>();
    } else {
      geometry_ = std::make_unique<GrabberGeometry<pcl::VLPGrabber>>();
    }
  }
  std::vector<std::size_t> by_elevation(static_cast<std::size_t>(count()));
  std::iota(by_elevation.begin(), by_elevation.end(), std::size_t{0});
  std::stable_sort(by_elevation.begin(), by_elevation.end(), [&](std::size_t a, std::size_t b) {
    return geometry_->elevation_deg(a) < geometry_->elevation_deg(b);
  });
  rings_.resize(by_elevation.size());
  for (std::size_t ring = 0; ring < by_elevation.size(); ++ring) {
    rings_[by_elevation[ring]] = static_cast<std::uint16_t>(ring);
  }
}

VelodyneLasers::~VelodyneLasers() = default;
VelodyneLasers::VelodyneLasers(VelodyneLasers&&) noexcept = default;
VelodyneLasers& VelodyneLasers::operator=(VelodyneLasers&&) noexcept = default;

int VelodyneLasers::count() const {
  return model_ == VelodyneModel::VLP_16 ? 16 : model_ == VelodyneModel::HDL_32E ? 32 : 64;
}

void VelodyneLasers::addReturns(const std::uint8_t* packet, const VelodyneFiring& firing, double time_s,
                                ScanPoints& scan) const {
  constexpr long kTurn = 36000;
  const bool two_returns = firing.second_return != 0;
  for (std::size_t laser = 0; laser < rings_.size(); ++laser) {
    const VelodyneReturn laser_return = velodyneReturn(packet, firing, laser);
    if (laser_return.distance == 0) continue;
    const double within_us = velodyneLaserTime_us(model_, laser, two_returns);
    const long azimuth = std::lround(firing.azimuth + firing.azimuth_rate * within_us) % kTurn;
    scan.points.push_back(geometry_->point(laser, static_cast<std::uint16_t>(azimuth), laser_return));
    scan.rings.push_back(rings_[laser]);
    scan.times_s.push_back(time_s + 1e-6 * within_us);
  }
}

}  // namespace saw_ndt::internal
