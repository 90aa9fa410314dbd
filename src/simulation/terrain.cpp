#include "simulation/terrain.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "common/executor.h"
#include "simulation/lattice_noise.h"

namespace saw_ndt {

using namespace internal;

namespace {

// The road's height at a point is a mean over the stations within this distance, the near ones weighing most.
constexpr double kHeightReach_m = 48.0;
constexpr double kHeightSmoothing_m = 4.0;
constexpr std::size_t kHeightStationStep = 4;
constexpr double kBlock_m = 16.0;
constexpr double kKerbWidth_m = 0.15;
constexpr double kRoadUndulation_m = 0.01;

double smoothStep(double share) {
  const double t = std::clamp(share, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

double cellSize(double distance_from_way_m) {
  if (distance_from_way_m < 10.0) return 0.25;
  return distance_from_way_m < 30.0 ? 0.5 : 2.0;
}

}  // namespace

/// The stations that points of a small area need.
struct Terrain::Surroundings {
  std::vector<std::uint32_t> edge_stations;    ///< those that may be the nearest
  std::vector<std::uint32_t> height_stations;  ///< every fourth within reach
};

Terrain::Terrain(const Route& route, const SceneDescription& scene, std::uint64_t seed)
    : route_(route),
      road_(scene.road),
      terrain_(scene.terrain),
      undulation_(std::make_unique<LatticeNoise>(mixedSeed(seed, 1), 12.0)),
      roughness_(std::make_unique<LatticeNoise>(mixedSeed(seed, 2), 0.6)),
      road_undulation_(std::make_unique<LatticeNoise>(mixedSeed(seed, 3), 5.0)) {}

Terrain::~Terrain() = default;

Terrain::Surroundings Terrain::surroundings(const Eigen::Vector2d& centre, double radius_m) const {
  Surroundings around;
  // Far out the reach of the mean grows with the distance, so that it never runs dry.
  double reach_m = kHeightReach_m + radius_m;
  std::vector<std::uint32_t> near = route_.stationsNear(centre, reach_m);
  while (near.empty() && reach_m < 2.0 * kExtent_m + radius_m) near = route_.stationsNear(centre, reach_m *= 1.5);
  double nearest_m = reach_m;
  for (const std::uint32_t i : near) {
    if (i % kHeightStationStep == 0) around.height_stations.push_back(i);
    nearest_m = std::min(nearest_m, (route_.stations()[i].position.head<2>() - centre).norm());
  }
  const double edge_reach_m = nearest_m + 2.0 * radius_m + std::max(road_.left_m, road_.right_m);
  for (const std::uint32_t i : near) {
    if ((route_.stations()[i].position.head<2>() - centre).norm() <= edge_reach_m) around.edge_stations.push_back(i);
  }
  return around;
}

double Terrain::baseHeight(const Surroundings& around, const Eigen::Vector2d& point) const {
  double weight_sum = 0.0, height_sum = 0.0;
  for (const std::uint32_t i : around.height_stations) {
    const RouteStation& station = route_.stations()[i];
    const Eigen::Vector2d offset = point - station.position.head<2>();
    const double squared = offset.squaredNorm() + kHeightSmoothing_m * kHeightSmoothing_m;
    const double weight = 1.0 / (squared * squared);
    weight_sum += weight;
    height_sum += weight * (station.position.z() + station.slope * offset.dot(station.direction));
  }
  return weight_sum > 0.0 ? height_sum / weight_sum : 0.0;
}

double Terrain::height(const Surroundings& around, const Eigen::Vector2d& point, double edge_distance_m) const {
  double height = baseHeight(around, point) + kRoadUndulation_m * (*road_undulation_)(point);
  height += road_.kerb_height_m * smoothStep(edge_distance_m / kKerbWidth_m);
  const double open_m = edge_distance_m - road_.sidewalk_width_m;
  if (open_m > 0.0) {
    height += terrain_.bank_height_m * smoothStep(open_m / terrain_.bank_width_m);
    height += terrain_.undulation_m * std::min(1.0, open_m / 8.0) * (*undulation_)(point);
    height += terrain_.roughness_m * std::min(1.0, open_m / 0.5) * (*roughness_)(point);
  }
  return height;
}

double Terrain::height(const Eigen::Vector2d& point) const {
  const Surroundings around = surroundings(point, 0.0);
  return height(around, point, roadEdgeDistance(route_, around.edge_stations, road_, point));
}

double Terrain::edgeDistance(const Eigen::Vector2d& point) const {
  return std::min(kExtent_m, roadEdgeDistance(route_, surroundings(point, 0.0).edge_stations, road_, point));
}

void Terrain::addBlock(const Eigen::Vector2d& corner, std::uint16_t road_material, std::uint16_t sidewalk_material,
                       std::uint16_t terrain_material, TriangleMesh& mesh) const {
  const Eigen::Vector2d centre = corner.array() + kBlock_m / 2.0;
  const double half_diagonal_m = kBlock_m * std::sqrt(0.5);
  const Surroundings around = surroundings(centre, half_diagonal_m);
  double nearest_m = kExtent_m;
  for (const std::uint32_t i : around.edge_stations) {
    nearest_m = std::min(nearest_m, (route_.stations()[i].position.head<2>() - centre).norm());
  }
  const double cell_m = cellSize(nearest_m - half_diagonal_m);
  const auto cells = static_cast<std::uint32_t>(std::lround(kBlock_m / cell_m));
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  std::vector<double> edge_distances;
  for (std::uint32_t y = 0; y <= cells; ++y) {
    for (std::uint32_t x = 0; x <= cells; ++x) {
      const Eigen::Vector2d point = corner + cell_m * Eigen::Vector2d(x, y);
      edge_distances.push_back(roadEdgeDistance(route_, around.edge_stations, road_, point));
      mesh.vertices.emplace_back(static_cast<float>(point.x()), static_cast<float>(point.y()),
                                 static_cast<float>(height(around, point, edge_distances.back())));
    }
  }
  for (std::uint32_t y = 0; y < cells; ++y) {
    for (std::uint32_t x = 0; x < cells; ++x) {
      const std::uint32_t a = y * (cells + 1) + x, b = a + 1, c = a + cells + 1, d = c + 1;
      const double edge_m = (edge_distances[a] + edge_distances[d]) / 2.0;
      const std::uint16_t material = edge_m < 0.0                      ? road_material
                                     : edge_m < road_.sidewalk_width_m ? sidewalk_material
                                                                       : terrain_material;
      mesh.triangles.push_back({first + a, first + b, first + d});
      mesh.triangles.push_back({first + a, first + d, first + c});
      mesh.materials.insert(mesh.materials.end(), 2, material);
    }
  }
}

TriangleMesh Terrain::mesh(std::uint16_t road_material, std::uint16_t sidewalk_material,
                           std::uint16_t terrain_material) const {
  std::set<std::pair<int, int>> blocks;
  const int reach = static_cast<int>(std::ceil(kExtent_m / kBlock_m));
  for (std::size_t i = 0; i < route_.stations().size(); i += static_cast<std::size_t>(kBlock_m / 2.0)) {
    const Eigen::Array2d block = (route_.stations()[i].position.head<2>().array() / kBlock_m).floor();
    for (int x = -reach; x <= reach; ++x) {
      for (int y = -reach; y <= reach; ++y) {
        if (x * x + y * y <= reach * reach) {
          blocks.emplace(static_cast<int>(block.x()) + x, static_cast<int>(block.y()) + y);
        }
      }
    }
  }
  const std::vector<std::pair<int, int>> ordered(blocks.begin(), blocks.end());
  std::vector<TriangleMesh> parts(ordered.size());
  internal::forEachChunkOffline(0, ordered.size(), [&](std::size_t i, int) {
    addBlock(kBlock_m * Eigen::Vector2d(ordered[i].first, ordered[i].second), road_material, sidewalk_material,
             terrain_material, parts[i]);
  });
  TriangleMesh mesh;
  for (TriangleMesh& part : parts) {
    append(part, mesh);
    part = TriangleMesh();
  }
  return mesh;
}

}  // namespace saw_ndt
