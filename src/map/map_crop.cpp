#include "saw_ndt/map/map_crop.h"

#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

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

}  // namespace

WeightedVoxelMap cropMap(const WeightedVoxelMap& map, const MapRegion& region) {
  std::vector<LabelledVoxelSums> kept;
  MapOrigin origin = map.origin();
  origin.point_count = 0;
  bool belongs = false;
  const LabelledVoxelSums* before = nullptr;
  for (const LabelledVoxelSums& entry : map.entries()) {
    if (before == nullptr || entry.voxel != before->voxel) {
      belongs = region((entry.voxel.cast<double>().array() + 0.5).matrix() * map.resolution());
    }
    before = &entry;
    if (!belongs) continue;
    kept.push_back(entry);
    origin.point_count += entry.sums.count;
  }
  return {origin, std::move(kept)};
}

MapRegion boxRegion(const Eigen::Vector3d& least_m, const Eigen::Vector3d& greatest_m) {
  const char* const names[] = {"least_m.x", "least_m.y", "least_m.z"};
  for (int axis = 0; axis < 3; ++axis) {
    checkOption(least_m[axis] < greatest_m[axis], names[axis], least_m[axis],
                ("below the greatest, " + std::to_string(greatest_m[axis])).c_str());
  }
  return [least_m, greatest_m](const Eigen::Vector3d& position_m) {
    return (position_m.array() >= least_m.array()).all() && (position_m.array() < greatest_m.array()).all();
  };
}

MapRegion polygonRegion(const std::vector<Eigen::Vector2d>& vertices_m) {
  checkOption(vertices_m.size() >= 3, "vertices_m.size()", vertices_m.size(), "3 or more");
  requireFinite(vertices_m, "vertices_m");
  std::vector<Eigen::Vector2d> closed = vertices_m;
  closed.push_back(vertices_m.front());
  const auto edges = std::make_shared<const internal::PolylineTree>(std::move(closed));
  return
      [edges](const Eigen::Vector3d& position_m) { return edges->crossingsToTheRight(position_m.head<2>()) % 2 == 1; };
}

MapRegion regionAround(const std::vector<Eigen::Vector2d>& points_m, double radius_m) {
  checkOption(!points_m.empty(), "points_m.size()", points_m.size(), "1 or more");
  checkOption(radius_m > 0.0 && std::isfinite(radius_m), "radius_m", radius_m, "positive");
  requireFinite(points_m, "points_m");
  const auto line = std::make_shared<const internal::PolylineTree>(points_m);
  return [line, radius_m](const Eigen::Vector3d& position_m) { return line->isWithin(position_m.head<2>(), radius_m); };
}

}  // namespace saw_ndt
