#pragma once

#include <cstdint>
#include <vector>

#include "saw_ndt/common/labels.h"
#include "saw_ndt/common/scan_view.h"
#include "saw_ndt/segmentation/segmentation_options.h"
#include "segmentation/pixel_image.h"
#include "segmentation/scan_projection.h"

namespace saw_ndt::internal {

/// A scan without beams on a level polar grid around the sensor: columns are sectors, rows are rings of distance, the
/// farthest first. The lowest points of a cell stand for it as an image in which ground can be followed outward, as in
/// a range image. Memory is kept from one project() to the next.
class GroundGrid : public PixelImage {
 public:
  /// Cell of a point that is no return.
  static constexpr std::int32_t kNoCell = -1;

  /// Sorts the returns of a scan into cells.
  void project(const ScanView& scan, const ScanProjection& projection);

  /// Labels every point: Ground near the ground of its cell, NonGround above it in components of cells that have enough
  /// points, Noise elsewhere.
  /// @param ground  1 for each cell whose lowest points are ground, as GroundDetection tells
  void label(const std::vector<std::uint8_t>& ground, const SegmentationOptions& options,
             std::vector<StructuralLabel>& labels);

 private:
  struct LevelPoint {
    std::uint32_t index;  ///< in the scan
    float horizontal_range;
    float height;
  };
  struct Component {
    std::int32_t points = 0;
    float lowest = 0.0F;
    float highest = 0.0F;
  };

  void placeLowest(std::int32_t cell);
  void labelGround(const std::vector<std::uint8_t>& ground, const GroundOptions& options);
  void growComponents();

  std::vector<float> height_of_point_;
  std::vector<float> horizontal_range_of_point_;
  std::vector<std::int32_t> cell_of_point_;
  std::vector<std::int32_t> first_of_cell_;  ///< in points_, one more than there are cells
  std::vector<LevelPoint> points_;           ///< by cells
  std::vector<StructuralLabel> point_labels_;
  std::vector<std::int32_t> obstacles_of_cell_;
  std::vector<std::int32_t> component_of_cell_;
  std::vector<std::int32_t> waiting_;
  std::vector<Component> components_;
};

}  // namespace saw_ndt::internal
