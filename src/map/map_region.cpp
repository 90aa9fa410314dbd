#include "saw_ndt/map/map_region.h"

#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>

#include "map/polyline_tree.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt {
namespace {

void requireFinite(const std::vector<Eigen::Vector2d>& points_m, const char* name) {
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    if (!points_m[i].allFinite()) {
      throw std::invalid_argument(std::string(name) + "[" + std::to_string(i) + "] is not finite");
    }
  }
}

// Around the middle of a box, no position of it is horizontally further away; some room for rounding.
double horizontalReach(const Eigen::AlignedBox3d& box_m) { return 0.5001 * box_m.sizes().head<2>().norm(); }

}  // namespace

MapRegion boxRegion(const Eigen::Vector3d& least_m, const Eigen::Vector3d& greatest_m) {
  const char* const names[] = {"least_m.x", "least_m.y", "least_m.z"};
  for (int axis = 0; axis < 3; ++axis) {
    checkOption(least_m[axis] < greatest_m[axis], names[axis], least_m[axis],
                ("below the greatest, " + std::to_string(greatest_m[axis])).c_str());
  }
  return {[least_m, greatest_m](const Eigen::Vector3d& position_m) {
            return (position_m.array() >= least_m.array()).all() && (position_m.array() < greatest_m.array()).all();
          },
          [least_m, greatest_m](const Eigen::AlignedBox3d& box_m) {
            return (box_m.max().array() >= least_m.array()).all() && (box_m.min().array() < greatest_m.array()).all();
          }};
}

MapRegion polygonRegion(const std::vector<Eigen::Vector2d>& vertices_m) {
  checkOption(vertices_m.size() >= 3, "vertices_m.size()", vertices_m.size(), "3 or more");
  requireFinite(vertices_m, "vertices_m");
  std::vector<Eigen::Vector2d> closed = vertices_m;
  closed.push_back(vertices_m.front());
  const auto edges = std::make_shared<const internal::PolylineTree>(std::move(closed));
  const auto contains = [edges](const Eigen::Vector3d& position_m) {
    return edges->crossingsToTheRight(position_m.head<2>()) % 2 == 1;
  };
  return {contains, [edges, contains](const Eigen::AlignedBox3d& box_m) {
            const Eigen::Vector3d middle_m = box_m.center();
            return edges->isWithin(middle_m.head<2>(), horizontalReach(box_m)) || contains(middle_m);
          }};
}

MapRegion regionAround(const std::vector<Eigen::Vector2d>& points_m, double radius_m) {
  checkOption(!points_m.empty(), "points_m.size()", points_m.size(), "1 or more");
  checkOption(radius_m > 0.0 && std::isfinite(radius_m), "radius_m", radius_m, "positive");
  requireFinite(points_m, "points_m");
  const auto line = std::make_shared<const internal::PolylineTree>(points_m);
  return {
      [line, radius_m](const Eigen::Vector3d& position_m) { return line->isWithin(position_m.head<2>(), radius_m); },
      [line, radius_m](const Eigen::AlignedBox3d& box_m) {
        return line->isWithin(box_m.center().head<2>(), radius_m + horizontalReach(box_m));
      }};
}

MapRegion commonRegion(const MapRegion& a, const MapRegion& b) {
  return {[a, b](const Eigen::Vector3d& position_m) { return a(position_m) && b(position_m); },
          [a, b](const Eigen::AlignedBox3d& box_m) { return a.mayMeet(box_m) && b.mayMeet(box_m); }};
}

}  // namespace saw_ndt
