#pragma once

#include <cstdint>
#include <vector>

#include "saw_ndt/common/labels.h"
#include "saw_ndt/common/sensor_model.h"
#include "saw_ndt/segmentation/range_image.h"

namespace saw_ndt {

/// Options of ComponentFilter; the defaults are LeGO-LOAM's.
struct ComponentOptions {
  /// Neighbours are connected where the line between them makes more than this angle in degrees with the line of sight
  /// to the farther one, above 0 and below 90.
  double connection_angle_deg = 60.0;
  /// A component of this many points or more, all returns of its pixels counted, is kept, at least 1.
  int minimum_points = 30;
  /// So is a smaller one of this many points or more, at least 1, if it spans enough rings.
  int minimum_points_tall = 5;
  /// Rings that such a smaller component must span, at least 1.
  int minimum_rings_tall = 3;

  /// Throws std::invalid_argument that names the field and its value.
  void check() const;
};

/// Groups the pixels that are no ground into connected components and tells the large from the small (section III.A of
/// the paper). Components are 4-connected and go on over the azimuth seam. Memory is kept from one image to the next.
class ComponentFilter {
 public:
  /// Labels every pixel, row-major: Ground where `ground` is 1, NonGround in components that are kept, and Noise in the
  /// others and where there is no return. The options have been checked, the image was projected with the sensor model.
  void label(const RangeImage& image, const SensorModel& sensor, const std::vector<std::uint8_t>& ground,
             const ComponentOptions& options, std::vector<StructuralLabel>& labels);

 private:
  /// Pixels of one row that are connected one to the next, as a node of a forest. A parent has a smaller number than
  /// its children, a root is its own parent.
  struct Run {
    std::int32_t parent;
    std::int32_t points;
    std::int32_t top_row;
    std::int32_t bottom_row;
  };

  void connectRow(int row, const RangeImage& image, const std::uint8_t* ground);
  void chooseComponents(const ComponentOptions& options);
  std::int32_t rootOf(std::int32_t run);
  void unite(std::int32_t first, std::int32_t second);

  std::int32_t run_end_ = 0;
  std::vector<Run> runs_;
  std::vector<std::int32_t> run_of_pixel_;
  std::vector<StructuralLabel> label_of_run_;
  std::vector<std::int32_t> links_;
  std::vector<float> current_;
  std::vector<float> above_;
};

}  // namespace saw_ndt
