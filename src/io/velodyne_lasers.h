#pragma once

#include <filesystem>
#include <memory>

#include "io/velodyne_packets.h"
#include "saw_ndt/common/export.h"
#include "saw_ndt/common/scan_view.h"

namespace saw_ndt::internal {

/// Where the lasers of a Velodyne point, and so where its returns lie; the geometry is that of PCL's grabbers.
///
/// Points are in the project's frame: x is where the azimuth is 0, opposite to the connector, y to the left, z up. That
/// is Velodyne's own frame, whose y axis is at azimuth 0 and x axis at 90 degrees, turned by a right angle. Lasers of a
/// VLP-16 and HDL-32E have their nominal elevations; up to 11 mm between the heights of a VLP-16's are left out.
class SAW_NDT_EXPORT VelodyneLasers {
 public:
  /// @param calibration  db.xml of an HDL-64E, whose distances must be in units of 2 mm; not looked at for others
  /// @throws Error where the calibration of an HDL-64E is empty, cannot be read or does not state all 64 lasers
  explicit VelodyneLasers(VelodyneModel model, const std::filesystem::path& calibration = {});
  ~VelodyneLasers();
  VelodyneLasers(VelodyneLasers&&) noexcept;
  VelodyneLasers& operator=(VelodyneLasers&&) noexcept;

  VelodyneModel model() const { return model_; }
  int count() const;

  /// Adds the returns of a firing to a scan, in the order of the lasers: rings by elevation, 0 the lowest; intensities
  /// 0 to 255; a time for each.
  /// @param packet  kVelodynePacketBytes bytes of a data packet of this model
  /// @param time_s  of the first laser
  void addReturns(const std::uint8_t* packet, const VelodyneFiring& firing, double time_s, ScanPoints& scan) const;

 private:
  class Geometry;
  template <typename Grabber>
  class GrabberGeometry;

  VelodyneModel model_;
  std::unique_ptr<Geometry> geometry_;
  std::vector<std::uint16_t> rings_;  // of the lasers
};

}  // namespace saw_ndt::internal
