#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace saw_ndt {

/// A point of a LiDAR scan: metres, LiDAR frame (x forward, y left, z up), and its intensity or reflectance.
struct LidarPoint {
  float x = 0.0F, y = 0.0F, z = 0.0F;
  float intensity = 0.0F;
};

/// A number that each point of a scan has beside its position, wherever it lies in memory.
class PointField {
 public:
  /// No point has it.
  PointField() = default;
  /// @param first         that of the first point
  /// @param stride_bytes  from one point's number to the next one's
  /// @param scale         what a number is multiplied by
  template <typename Number>
  explicit PointField(const Number* first, std::size_t stride_bytes = sizeof(Number), double scale = 1.0)
      : first_(reinterpret_cast<const unsigned char*>(first)),
        stride_bytes_(stride_bytes),
        scale_(scale),
        read_(&readAs<Number>) {
    static_assert(std::is_arithmetic_v<Number>, "a point field holds numbers");
  }

  /// Whether the points have it.
  bool known() const { return first_ != nullptr; }
  /// That of a point; only where it is known.
  double operator[](std::size_t point) const { return scale_ * read_(first_ + point * stride_bytes_); }

 private:
  template <typename Number>
  static double readAs(const unsigned char* at) {
    return static_cast<double>(*reinterpret_cast<const Number*>(at));
  }

  const unsigned char* first_ = nullptr;
  std::size_t stride_bytes_ = 0;
  double scale_ = 1.0;
  double (*read_)(const unsigned char*) = nullptr;
};

/// One scan as this library reads it, whatever the point type: nothing is copied, nothing is owned. Threads may share
/// it while nobody writes to what it views.
struct ScanView {
  /// x of the first point; y and z follow it. Metres, LiDAR frame: x forward, y left, z up.
  const float* xyz = nullptr;
  /// Floats from one point's x to the next one's (at least 3).
  std::size_t stride = 4;
  /// Number of points.
  std::size_t size = 0;
  /// Ring number of each point, where the points have one. Rings may be numbered from the top or the bottom.
  PointField rings;
  /// When each point was measured (s), where that is known; from the stamp of the scan or absolute, as its source has
  /// it.
  PointField times_s;
  /// Points per row of an organized cloud; ignored where height is 1.
  std::size_t width = 0;
  /// Rows of an organized cloud, 1 for an unorganized one.
  std::size_t height = 1;

  const float* point(std::size_t index) const { return xyz + index * stride; }
};

/// The points of one scan and what its sensor tells of each, owned.
struct ScanPoints {
  std::vector<LidarPoint> points;    ///< in the order of the sensor
  std::vector<std::uint16_t> rings;  ///< ring number of each point; empty where they are not known
  std::vector<double> times_s;       ///< as ScanView::times_s; empty where they are not known
  std::size_t width = 0;             ///< points per row of an organized cloud; ignored where height is 1
  std::size_t height = 1;            ///< rows of an organized cloud, 1 for an unorganized one
};

/// A view of points one after the other.
inline ScanView viewOf(const std::vector<LidarPoint>& points) {
  ScanView view;
  view.xyz = points.empty() ? nullptr : &points.front().x;
  view.size = points.size();
  view.width = points.size();
  return view;
}

/// A view of a scan with all that is known of its points.
inline ScanView viewOf(const ScanPoints& scan) {
  ScanView view = viewOf(scan.points);
  if (!scan.rings.empty()) view.rings = PointField(scan.rings.data());
  if (!scan.times_s.empty()) view.times_s = PointField(scan.times_s.data());
  if (scan.height > 1) {
    view.width = scan.width;
    view.height = scan.height;
  }
  return view;
}

}  // namespace saw_ndt
