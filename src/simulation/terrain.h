#pragma once

#include <cstdint>
#include <memory>

#include "simulation/route.h"
#include "simulation/scene.h"
#include "simulation/scene_description.h"

namespace saw_ndt {

class LatticeNoise;

/// The ground under and beside a road.
class Terrain {
 public:
  static constexpr double kExtent_m = 80.0;  ///< how far from the way there is ground

  /// @param route  kept as a reference
  Terrain(const Route& route, const SceneDescription& scene, std::uint64_t seed);
  ~Terrain();

  /// Height of the ground at a point (m): follows the way, kerb, bank and open ground beside it.
  double height(const Eigen::Vector2d& point) const;

  /// Distance from the edge of the road (m), negative on it; kExtent_m where that is greater.
  double edgeDistance(const Eigen::Vector2d& point) const;

  /// The ground as a mesh, finest near the road, of materials road, sidewalk and terrain.
  TriangleMesh mesh(std::uint16_t road_material, std::uint16_t sidewalk_material, std::uint16_t terrain_material) const;

 private:
  struct Surroundings;
  Surroundings surroundings(const Eigen::Vector2d& centre, double radius_m) const;
  double baseHeight(const Surroundings& around, const Eigen::Vector2d& point) const;
  double height(const Surroundings& around, const Eigen::Vector2d& point, double edge_distance_m) const;
  void addBlock(const Eigen::Vector2d& corner, std::uint16_t road_material, std::uint16_t sidewalk_material,
                std::uint16_t terrain_material, TriangleMesh& mesh) const;

  const Route& route_;
  RoadDescription road_;
  TerrainDescription terrain_;
  std::unique_ptr<LatticeNoise> undulation_, roughness_, road_undulation_;
};

}  // namespace saw_ndt
