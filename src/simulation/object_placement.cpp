#include "simulation/object_placement.h"

#include <algorithm>
#include <boost/container_hash/hash.hpp>
#include <cmath>
#include <unordered_set>
#include <utility>

#include "saw_ndt/common/geometry.h"
#include "simulation/object_meshes.h"
#include "simulation/random_numbers.h"

namespace saw_ndt {
namespace {

constexpr int kVariants = 6;
constexpr double kOccupancyCell_m = 0.5;
constexpr double kFootprintMargin_m = 0.3;
/// How much nearer to the road than its row says a corner of an object may come, in bends.
constexpr double kEdgeTolerance_m = 0.4;

struct Variant {
  ObjectSize size;
  std::uint32_t mesh;
};

struct Footprint {
  Eigen::Vector2d centre, half_size;
  Eigen::Rotation2Dd rotation;

  Eigen::Vector2d at(double x_share, double y_share) const {
    return centre + rotation * Eigen::Vector2d(x_share * half_size.x(), y_share * half_size.y());
  }
};

bool liesAlongGround(const std::string& kind) {
  for (const char* along : {"wall", "sound_wall", "ceiling", "fence", "hedge", "guard_rail", "car", "truck"}) {
    if (kind == along) return true;
  }
  return false;
}

class Placement {
 public:
  Placement(const SceneDescription& description, const Route& route, const Terrain& terrain,
            const DriveOptions& options, Scene& scene)
      : description_(description), route_(route), terrain_(terrain), options_(options), scene_(scene) {}

  void placeRow(std::size_t number) {
    const ObjectRow& row = description_.rows[number];
    const std::uint64_t seed = mixedSeed(options_.seed, number, row.per_drive ? options_.drive : 0);
    SceneRandom random(seed);
    const std::vector<Variant> variants = makeVariants(row, random);
    if (row.left) placeSide(row, variants, 1.0, random);
    if (row.right) placeSide(row, variants, -1.0, random);
  }

 private:
  using Cell = std::pair<int, int>;

  std::vector<Variant> makeVariants(const ObjectRow& row, SceneRandom& random) {
    std::vector<Variant> variants;
    for (int i = 0; i < (row.alike ? 1 : kVariants); ++i) {
      const ObjectSize size{random.uniform(row.length_m), random.uniform(row.width_m), random.uniform(row.height_m)};
      variants.push_back({size, static_cast<std::uint32_t>(scene_.meshes.size())});
      scene_.meshes.push_back(makeObjectMesh(row.object, size, false, mixedSeed(random.index(1u << 30))));
    }
    return variants;
  }

  void placeSide(const ObjectRow& row, const std::vector<Variant>& variants, double side, SceneRandom& random) {
    double section_end_m = 0.0, from_edge_m = 0.0;
    bool present = false;
    const double end_m = std::min(row.along_m.max, route_.length_m());
    for (double along_m = row.along_m.min + random.uniform(0.0, row.spacing_m.max); along_m < end_m;) {
      if (along_m >= section_end_m) {
        section_end_m = along_m + std::max(random.uniform(row.section_m), 1e-6);
        from_edge_m = random.uniform(row.from_edge_m);
        present = random.chance(row.probability) && random.chance(options_.object_density);
      }
      const Variant& variant = variants[random.index(variants.size())];
      const double turn = radiansFromDegrees(random.uniform(-row.heading_deg, row.heading_deg));
      if (present) place(row, variant, along_m, side, from_edge_m, turn);
      along_m += random.uniform(row.spacing_m);
    }
  }

  void place(const ObjectRow& row, const Variant& variant, double along_m, double side, double from_edge_m,
             double turn) {
    const RouteStation station = route_.at(along_m);
    const double road_m = side > 0.0 ? description_.road.left_m : description_.road.right_m;
    const double lateral_m = side * (road_m + from_edge_m + variant.size.width_m / 2.0);
    // y points away from the road.
    const double heading = std::atan2(station.direction.y(), station.direction.x()) + (side > 0.0 ? 0.0 : kPi) + turn;
    Footprint footprint{station.position.head<2>() + lateral_m * station.left(),
                        {variant.size.length_m / 2.0, variant.size.width_m / 2.0},
                        Eigen::Rotation2Dd(heading)};
    if (row.object == "tree") footprint.half_size.setConstant(0.3);
    if (!keepsOffRoad(footprint, from_edge_m) || !isFree(footprint)) return;
    if (row.object != "tuft") occupy(footprint);

    double pitch = 0.0;
    if (liesAlongGround(row.object)) {
      const double rise_m = terrain_.height(footprint.at(1.0, 0.0)) - terrain_.height(footprint.at(-1.0, 0.0));
      pitch = -std::atan2(rise_m, variant.size.length_m);
    }
    PlacedObject& object = scene_.objects.emplace_back();
    object.mesh = variant.mesh;
    object.T_scene_object =
        Eigen::Translation3f(static_cast<float>(footprint.centre.x()), static_cast<float>(footprint.centre.y()),
                             static_cast<float>(terrain_.height(footprint.centre))) *
        Eigen::AngleAxisf(static_cast<float>(heading), Eigen::Vector3f::UnitZ()) *
        Eigen::AngleAxisf(static_cast<float>(pitch), Eigen::Vector3f::UnitY());
  }

  bool keepsOffRoad(const Footprint& footprint, double from_edge_m) const {
    for (const double x : {-1.0, 0.0, 1.0}) {
      for (const double y : {-1.0, 1.0}) {
        if (terrain_.edgeDistance(footprint.at(x, y)) < from_edge_m - kEdgeTolerance_m) return false;
      }
    }
    return true;
  }

  template <typename Visit>
  static void forEachCell(const Footprint& footprint, Visit visit) {
    Footprint inner = footprint;
    inner.half_size = (footprint.half_size.array() - kFootprintMargin_m).max(0.0);
    const auto steps = [](double half_m) { return static_cast<int>(std::ceil(2.0 * half_m / kOccupancyCell_m)); };
    const int nx = std::max(1, steps(inner.half_size.x())), ny = std::max(1, steps(inner.half_size.y()));
    for (int i = 0; i <= nx; ++i) {
      for (int j = 0; j <= ny; ++j) {
        const Eigen::Vector2d point = inner.at(2.0 * i / nx - 1.0, 2.0 * j / ny - 1.0) / kOccupancyCell_m;
        visit(Cell(static_cast<int>(std::floor(point.x())), static_cast<int>(std::floor(point.y()))));
      }
    }
  }

  bool isFree(const Footprint& footprint) const {
    bool free = true;
    forEachCell(footprint, [&](const Cell& cell) { free = free && occupied_.count(cell) == 0; });
    return free;
  }

  void occupy(const Footprint& footprint) {
    forEachCell(footprint, [&](const Cell& cell) { occupied_.insert(cell); });
  }

  const SceneDescription& description_;
  const Route& route_;
  const Terrain& terrain_;
  const DriveOptions& options_;
  Scene& scene_;
  std::unordered_set<Cell, boost::hash<Cell>> occupied_;
};

}  // namespace

void placeObjects(const SceneDescription& description, const Route& route, const Terrain& terrain,
                  const DriveOptions& options, Scene& scene) {
  Placement placement(description, route, terrain, options, scene);
  // What is the same in every drive comes first, so that no parked car moves a building.
  for (const bool per_drive : {false, true}) {
    for (std::size_t number = 0; number < description.rows.size(); ++number) {
      if (description.rows[number].per_drive == per_drive) placement.placeRow(number);
    }
  }
}

}  // namespace saw_ndt
