#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>

#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

/// A square column of space, by its x and y in edges of kGroundCell_m.
using GroundCell = std::uint64_t;
constexpr double kGroundCell_m = 1.0;

/// The ground of a cloud as a plane for each cell that it has points in.
class SAW_NDT_EXPORT GroundSurface {
 public:
  /// Height above the middle of the cell, and how it grows with x and y.
  struct Plane {
    double height_m = 0.0, slope_x = 0.0, slope_y = 0.0;
  };

  GroundSurface() = default;
  explicit GroundSurface(std::unordered_map<GroundCell, Plane> planes) : planes_(std::move(planes)) {}

  /// Whether a point lies from 0.3 m below to 0.2 m above the ground of its cell; map frame (m).
  bool isGround(const float* xyz) const;

 private:
  std::unordered_map<GroundCell, Plane> planes_;
};

/// Collects how high the lowest points of each cell lie, in memory that grows with the area alone: of the 6.4 m above
/// the lowest point the number of points in each 0.1 m, up to 255. The result does not depend on the order of points.
class SAW_NDT_EXPORT LowestHeights {
 public:
  /// Adds a point; one that is not finite is passed over.
  void add(const float* xyz);

  /// The ground: the lowest layer of each cell that is no outlier, as far as it does not stand above the layers of the
  /// cells around by more than ground may rise (30 %), smoothed by planes over 3 m. Where there is none around, a cell
  /// has no ground.
  GroundSurface surface() const;

 private:
  static constexpr int kBins = 64;
  static constexpr double kBin_m = 0.1;

  struct Column {
    std::int32_t lowest_bin = 0;  // of counts[0]
    std::array<std::uint8_t, kBins> counts{};
  };

  /// False where the column has too few points to tell.
  static bool lowestLayer(const Column& column, double& height_m);

  std::unordered_map<GroundCell, Column> columns_;
};

}  // namespace saw_ndt::internal
