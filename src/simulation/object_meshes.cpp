#include "simulation/object_meshes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "simulation/mesh_builder.h"

namespace saw_ndt {
namespace {

using Vector = Eigen::Vector3d;

struct Workshop {
  MeshBuilder& builder;
  const ObjectSize& size;
  SceneRandom& random;

  double x() const { return size.length_m / 2.0; }
  double y() const { return size.width_m / 2.0; }
  double z() const { return size.height_m; }
};

/// Walls with windows and balconies on both long sides, a pitched roof, a chimney.
void makeBuilding(Workshop& w) {
  const double eaves = 0.75 * w.z();
  w.builder.addBox({-w.x(), -w.y(), -1.0}, {w.x(), w.y(), eaves}, SceneMaterial::FACADE);
  const double overhang = 0.4;
  for (const double side : {-1.0, 1.0}) {
    w.builder.addQuad({-w.x() - overhang, side * (w.y() + overhang), eaves - 0.2}, {-w.x() - overhang, 0.0, w.z()},
                      {w.x() + overhang, 0.0, w.z()}, {w.x() + overhang, side * (w.y() + overhang), eaves - 0.2},
                      SceneMaterial::ROOF);
    w.builder.addTriangle({side * w.x(), -w.y(), eaves}, {side * w.x(), w.y(), eaves}, {side * w.x(), 0.0, w.z()},
                          SceneMaterial::FACADE);
    const int floors = std::max(1, static_cast<int>(eaves / 2.8));
    const int windows = std::max(1, static_cast<int>(w.size.length_m / 3.0));
    for (int floor = 0; floor < floors; ++floor) {
      for (int window = 0; window < windows; ++window) {
        const double middle = -w.x() + (window + 0.5) * w.size.length_m / windows;
        const double sill = 0.9 + 2.8 * floor, wall = side * w.y();
        if (floor > 0 && w.random.chance(0.25)) {  // a balcony
          w.builder.addBox({middle - 1.2, std::min(wall, wall + side * 1.2), sill - 1.0},
                           {middle + 1.2, std::max(wall, wall + side * 1.2), sill + 0.1}, SceneMaterial::FACADE);
        } else if (w.random.chance(0.8)) {  // a pane, with a frame that stands out of the wall
          const double pane = wall + side * 0.02;
          w.builder.addQuad({middle - 0.6, pane, sill}, {middle + 0.6, pane, sill}, {middle + 0.6, pane, sill + 1.3},
                            {middle - 0.6, pane, sill + 1.3}, SceneMaterial::FACADE_GLASS);
          w.builder.addBox({middle - 0.75, std::min(wall, wall + side * 0.15), sill - 0.12},
                           {middle + 0.75, std::max(wall, wall + side * 0.15), sill}, SceneMaterial::FACADE);
        }
      }
    }
    if (w.random.chance(0.6)) {  // a porch
      const double middle = w.random.uniform(-w.x() + 1.5, w.x() - 1.5), wall = side * w.y();
      w.builder.addBox({middle - 1.3, std::min(wall, wall + side * 1.5), -1.0},
                       {middle + 1.3, std::max(wall, wall + side * 1.5), 2.6}, SceneMaterial::FACADE);
    }
  }
  const double chimney = w.random.uniform(-0.7, 0.7) * w.x();
  w.builder.addBox({chimney - 0.4, -0.4, eaves}, {chimney + 0.4, 0.4, w.z() + 0.8}, SceneMaterial::FACADE);
}

void makeWall(Workshop& w) { w.builder.addBox({-w.x(), -w.y(), -0.5}, {w.x(), w.y(), w.z()}, SceneMaterial::CONCRETE); }

/// A plate overhead whose upper side is at the full height, such as that of a tunnel.
void makeCeiling(Workshop& w) {
  w.builder.addBox({-w.x(), -w.y(), w.z() - 0.4}, {w.x(), w.y(), w.z()}, SceneMaterial::CONCRETE);
}

/// Panels between pilasters.
void makeSoundWall(Workshop& w) {
  w.builder.addBox({-w.x(), -0.06, -0.5}, {w.x(), 0.06, w.z()}, SceneMaterial::CONCRETE);
  w.builder.addBox({-w.x() - 0.12, -w.y(), -0.5}, {-w.x() + 0.12, w.y(), w.z() + 0.1}, SceneMaterial::CONCRETE);
}

/// Posts, rails and pales with gaps.
void makeFence(Workshop& w) {
  for (const double x : {-w.x(), 0.0}) {
    w.builder.addBox({x - 0.05, -0.05, -0.5}, {x + 0.05, 0.05, w.z() + 0.1}, SceneMaterial::WOOD);
  }
  for (const double z : {0.25 * w.z(), 0.85 * w.z()}) {
    w.builder.addBox({-w.x(), -0.03, z - 0.04}, {w.x(), 0.03, z + 0.04}, SceneMaterial::WOOD);
  }
  for (double x = -w.x() + 0.1; x < w.x(); x += 0.2) {
    w.builder.addQuad({x - 0.05, 0.04, 0.05}, {x + 0.05, 0.04, 0.05}, {x + 0.05, 0.04, w.z()}, {x - 0.05, 0.04, w.z()},
                      SceneMaterial::WOOD);
  }
}

/// Leaves near the surface of a box whose inside lets nothing through.
void makeHedge(Workshop& w) {
  w.builder.addBox({-w.x(), -w.y() + 0.2, 0.0}, {w.x(), w.y() - 0.2, w.z() - 0.2}, SceneMaterial::LEAF);
  const double surface = 2.0 * w.size.length_m * (w.z() + w.y());
  const auto draw = [&w](SceneRandom& random) {
    const double depth = random.uniform(0.0, 0.3);
    const double x = random.uniform(-w.x(), w.x());
    if (random.chance(w.y() / (w.z() + w.y()))) return Vector(x, random.uniform(-w.y(), w.y()), w.z() - depth);
    return Vector(x, random.chance(0.5) ? w.y() - depth : depth - w.y(), random.uniform(0.05, w.z()));
  };
  w.builder.addLeaves(static_cast<int>(40.0 * surface), 0.15, draw, w.random);
}

/// Leaves within an ellipsoid around `middle` with the given half axes, more of them near its surface.
void addCrown(Workshop& w, const Vector& middle, const Vector& half_axes, double leaf_m, double leaves_m2) {
  const double surface = 4.0 * half_axes.x() * half_axes.z() * 3.0;
  const auto draw = [&](SceneRandom& random) -> Vector {
    Vector direction;
    do {
      direction = Vector(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
    } while (direction.squaredNorm() > 1.0 || direction.squaredNorm() < 1e-4);
    const double radius = std::cbrt(random.uniform(0.15, 1.0));
    return middle + (half_axes.array() * direction.normalized().array() * radius).matrix();
  };
  w.builder.addLeaves(static_cast<int>(leaves_m2 * surface), leaf_m, draw, w.random);
}

void makeTree(Workshop& w) {
  const double bare = std::min(2.2, 0.35 * w.z());
  const double trunk = 0.02 * w.z() + w.random.uniform(0.02, 0.12);
  w.builder.addColumn({0.0, 0.0, -0.5}, trunk, 0.5 * trunk, 0.5 + 0.8 * w.z(), SceneMaterial::BARK);
  addCrown(w, {0.0, 0.0, (bare + w.z()) / 2.0}, {w.x(), w.y(), (w.z() - bare) / 2.0}, 0.3, 12.0);
}

void makeBush(Workshop& w) { addCrown(w, {0.0, 0.0, 0.45 * w.z()}, {w.x(), w.y(), 0.55 * w.z()}, 0.15, 40.0); }

/// Blades of grass and herbs.
void makeTuft(Workshop& w) {
  const auto draw = [&w](SceneRandom& random) {
    return Vector(random.uniform(-w.x(), w.x()), random.uniform(-w.y(), w.y()), random.uniform(0.0, w.z()));
  };
  w.builder.addLeaves(static_cast<int>(20.0 * w.size.length_m * w.size.width_m), 0.15, draw, w.random);
}

void makePole(Workshop& w) {
  w.builder.addColumn({0.0, 0.0, -0.5}, w.x(), w.x(), w.z() + 0.5, SceneMaterial::METAL_POLE);
}

/// A pole with an arm towards the road, which lies at -y.
void makeLamp(Workshop& w) {
  w.builder.addColumn({0.0, 0.0, -0.5}, 0.1, 0.05, w.z() + 0.5, SceneMaterial::METAL_POLE);
  w.builder.addBox({-0.04, -w.size.width_m, w.z() - 0.1}, {0.04, 0.0, w.z()}, SceneMaterial::METAL_POLE);
  w.builder.addBox({-0.15, -w.size.width_m - 0.5, w.z() - 0.15}, {0.15, -w.size.width_m, w.z()},
                   SceneMaterial::METAL_POLE);
}

/// A plate across the road's direction on a pole.
void makeSign(Workshop& w) {
  w.builder.addColumn({0.0, 0.0, -0.5}, 0.04, 0.04, w.z() + 0.5, SceneMaterial::METAL_POLE);
  w.builder.addQuad({-0.06, -w.y(), w.z() - w.size.width_m}, {-0.06, w.y(), w.z() - w.size.width_m},
                    {-0.06, w.y(), w.z()}, {-0.06, -w.y(), w.z()}, SceneMaterial::SIGN_PLATE);
}

/// A beam with its fold, on posts.
void makeGuardRail(Workshop& w) {
  for (const double z : {w.z() - 0.31, w.z() - 0.15}) {
    w.builder.addBox({-w.x(), -0.04, z}, {w.x(), 0.04, z + 0.12}, SceneMaterial::GUARD_RAIL);
  }
  w.builder.addBox({-w.x() - 0.05, 0.04, -0.5}, {-w.x() + 0.05, 0.16, w.z()}, SceneMaterial::GUARD_RAIL);
}

void addWheels(Workshop& w, double from_ends, double radius) {
  for (const double x : {-w.x() + from_ends, w.x() - from_ends}) {
    for (const double y : {-w.y() + 0.15, w.y() - 0.15}) {
      w.builder.addWheel({x, y, radius}, radius, 0.22, SceneMaterial::TYRE);
    }
  }
}

void makeCar(Workshop& w) {
  const SceneMaterial paint = w.random.chance(0.3) ? SceneMaterial::CAR_PAINT_DARK : SceneMaterial::CAR_PAINT;
  const double l = w.x(), h = w.z();
  const double belt = 0.58 * h;
  w.builder.addExtrusion(
      {{-l, 0.2}, {l, 0.2}, {l, 0.45 * h}, {0.45 * l, belt}, {-0.85 * l, belt + 0.03}, {-l, 0.5 * h}}, w.y(), paint);
  w.builder.addExtrusion({{0.45 * l, belt}, {0.1 * l, 0.97 * h}, {-0.55 * l, 0.97 * h}, {-0.85 * l, belt}}, w.y() - 0.1,
                         SceneMaterial::CAR_GLASS);
  w.builder.addBox({-0.55 * l, -w.y() + 0.12, 0.96 * h}, {0.1 * l, w.y() - 0.12, h}, paint);
  addWheels(w, 0.8, 0.32);
}

void makeTruck(Workshop& w) {
  w.builder.addBox({-w.x(), -w.y(), 1.1}, {w.x() - 2.2, w.y(), w.z()}, SceneMaterial::TRUCK_BODY);
  w.builder.addBox({w.x() - 2.0, -w.y(), 0.5}, {w.x(), w.y(), 0.85 * w.z()}, SceneMaterial::TRUCK_BODY);
  w.builder.addBox({-w.x(), -0.4, 0.6}, {w.x() - 2.0, 0.4, 1.1}, SceneMaterial::TRUCK_BODY);
  addWheels(w, 1.2, 0.5);
}

void makePerson(Workshop& w) {
  for (const double y : {-0.1, 0.1}) w.builder.addColumn({0.0, y, 0.0}, 0.07, 0.09, 0.5 * w.z(), SceneMaterial::CLOTH);
  w.builder.addColumn({0.0, 0.0, 0.47 * w.z()}, 0.17, 0.22, 0.36 * w.z(), SceneMaterial::CLOTH);
  w.builder.addColumn({0.0, 0.0, 0.85 * w.z()}, 0.1, 0.1, 0.15 * w.z(), SceneMaterial::CLOTH);
}

const std::map<std::string, void (*)(Workshop&)>& makers() {
  static const std::map<std::string, void (*)(Workshop&)> all = {
      {"building", makeBuilding}, {"wall", makeWall},   {"sound_wall", makeSoundWall},
      {"fence", makeFence},       {"hedge", makeHedge}, {"tree", makeTree},
      {"bush", makeBush},         {"tuft", makeTuft},   {"pole", makePole},
      {"lamp", makeLamp},         {"sign", makeSign},   {"guard_rail", makeGuardRail},
      {"car", makeCar},           {"truck", makeTruck}, {"person", makePerson},
      {"ceiling", makeCeiling},
  };
  return all;
}

}  // namespace

const std::vector<std::string>& objectKinds() {
  static const std::vector<std::string> kinds = [] {
    std::vector<std::string> names;
    for (const auto& maker : makers()) names.push_back(maker.first);
    return names;
  }();
  return kinds;
}

TriangleMesh makeObjectMesh(const std::string& kind, const ObjectSize& size, bool moving, std::uint64_t seed) {
  const auto maker = makers().find(kind);
  if (maker == makers().end()) throw std::invalid_argument("object = " + kind + ": must be one of objectKinds()");
  MeshBuilder builder(moving);
  SceneRandom random(seed);
  Workshop workshop{builder, size, random};
  maker->second(workshop);
  return builder.take();
}

}  // namespace saw_ndt
