#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>
#include <type_traits>
#include <utility>
#include <vector>

#include "saw_ndt/common/export.h"

namespace saw_ndt {

/// Tells of a position in the map frame (m) whether it belongs, and of a box whether any position of it may: of a large
/// map, boxes of which none belongs are not looked at. Its functions are asked by several threads at a time where what
/// takes it has threads; the regions below are safe to share.
class SAW_NDT_EXPORT MapRegion {
 public:
  using Contains = std::function<bool(const Eigen::Vector3d& position_m)>;
  using MayMeet = std::function<bool(const Eigen::AlignedBox3d& box_m)>;

  /// Any function of a position is a region, of which nothing is known but what it says.
  template <typename Function, typename = std::enable_if_t<std::is_invocable_r_v<bool, Function, Eigen::Vector3d> &&
                                                           !std::is_same_v<std::decay_t<Function>, MapRegion>>>
  MapRegion(Function contains) : contains_(std::move(contains)) {}  // NOLINT: as functions were before
  /// @param may_meet  false only where no position of a box, its sides included, belongs
  MapRegion(Contains contains, MayMeet may_meet) : contains_(std::move(contains)), may_meet_(std::move(may_meet)) {}

  bool operator()(const Eigen::Vector3d& position_m) const { return contains_(position_m); }
  bool mayMeet(const Eigen::AlignedBox3d& box_m) const { return !may_meet_ || may_meet_(box_m); }

 private:
  Contains contains_;
  MayMeet may_meet_;
};

/// Positions from a least corner to a greatest one. The least coordinates belong, the greatest do not, so that a
/// position belongs to one of two boxes side by side. Corners may be infinite.
/// @throws std::invalid_argument unless every coordinate of the least corner is below that of the greatest
SAW_NDT_EXPORT MapRegion boxRegion(const Eigen::Vector3d& least_m, const Eigen::Vector3d& greatest_m);

/// Positions above and below a polygon: those from which a line to the right crosses its edges an odd number of times.
/// Of polygons side by side each position belongs to one.
/// @param vertices_m  x and y of three or more, finite; the last one is joined to the first
/// @throws std::invalid_argument
SAW_NDT_EXPORT MapRegion polygonRegion(const std::vector<Eigen::Vector2d>& vertices_m);

/// Positions whose horizontal distance from a line through points, in their order, is at most `radius_m`.
/// @param points_m  x and y of one or more, finite
/// @throws std::invalid_argument
SAW_NDT_EXPORT MapRegion regionAround(const std::vector<Eigen::Vector2d>& points_m, double radius_m);

/// Positions that belong to both of two regions.
SAW_NDT_EXPORT MapRegion commonRegion(const MapRegion& a, const MapRegion& b);

}  // namespace saw_ndt
