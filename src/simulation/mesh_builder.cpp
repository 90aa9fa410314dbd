#include "simulation/mesh_builder.h"

#include <cmath>

#include "saw_ndt/common/geometry.h"

namespace saw_ndt {
namespace {

constexpr int kSides = 10;

Eigen::Vector2d onCircle(int side, double radius) {
  const double angle = 2.0 * kPi * side / kSides;
  return radius * Eigen::Vector2d(std::cos(angle), std::sin(angle));
}

Eigen::Vector3d randomDirection(SceneRandom& random) {
  const double z = random.uniform(-1.0, 1.0), angle = random.uniform(0.0, 2.0 * kPi);
  const double radius = std::sqrt(1.0 - z * z);
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

}  // namespace

void MeshBuilder::addTriangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                              SceneMaterial material) {
  const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
  for (const Eigen::Vector3d* vertex : {&a, &b, &c}) mesh_.vertices.push_back(vertex->cast<float>());
  mesh_.triangles.push_back({first, first + 1, first + 2});
  mesh_.materials.push_back(materialIndex(material, moving_));
}

void MeshBuilder::addQuad(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                          const Eigen::Vector3d& d, SceneMaterial material) {
  addTriangle(a, b, c, material);
  addTriangle(a, c, d, material);
}

void MeshBuilder::addBox(const Eigen::Vector3d& low, const Eigen::Vector3d& high, SceneMaterial material) {
  const auto corner = [&](bool x, bool y, bool z) {
    return Eigen::Vector3d(x ? high.x() : low.x(), y ? high.y() : low.y(), z ? high.z() : low.z());
  };
  for (const bool side : {false, true}) {
    addQuad(corner(side, false, false), corner(side, true, false), corner(side, true, true), corner(side, false, true),
            material);
    addQuad(corner(false, side, false), corner(true, side, false), corner(true, side, true), corner(false, side, true),
            material);
  }
  addQuad(corner(false, false, true), corner(true, false, true), corner(true, true, true), corner(false, true, true),
          material);
}

void MeshBuilder::addColumn(const Eigen::Vector3d& foot, double radius_low, double radius_high, double height,
                            SceneMaterial material) {
  const Eigen::Vector3d top = foot + height * Eigen::Vector3d::UnitZ();
  for (int side = 0; side < kSides; ++side) {
    Eigen::Vector3d a = foot, b = foot, c = top, d = top;
    a.head<2>() += onCircle(side, radius_low);
    b.head<2>() += onCircle(side + 1, radius_low);
    c.head<2>() += onCircle(side + 1, radius_high);
    d.head<2>() += onCircle(side, radius_high);
    addQuad(a, b, c, d, material);
    addTriangle(d, c, top, material);
  }
}

void MeshBuilder::addWheel(const Eigen::Vector3d& centre, double radius, double width, SceneMaterial material) {
  for (int side = 0; side < kSides; ++side) {
    const Eigen::Vector2d from = onCircle(side, radius), to = onCircle(side + 1, radius);
    const Eigen::Vector3d half(0.0, width / 2.0, 0.0);
    const Eigen::Vector3d a = centre + Eigen::Vector3d(from.x(), 0.0, from.y());
    const Eigen::Vector3d b = centre + Eigen::Vector3d(to.x(), 0.0, to.y());
    addQuad(a - half, b - half, b + half, a + half, material);
    addTriangle(centre - half, a - half, b - half, material);
    addTriangle(centre + half, a + half, b + half, material);
  }
}

void MeshBuilder::addExtrusion(const std::vector<Eigen::Vector2d>& outline, double half_width, SceneMaterial material) {
  const auto at = [](const Eigen::Vector2d& point, double y) { return Eigen::Vector3d(point.x(), y, point.y()); };
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& point : outline) middle += point / static_cast<double>(outline.size());
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d &from = outline[i], &to = outline[(i + 1) % outline.size()];
    addQuad(at(from, -half_width), at(to, -half_width), at(to, half_width), at(from, half_width), material);
    for (const double y : {-half_width, half_width}) addTriangle(at(middle, y), at(from, y), at(to, y), material);
  }
}

void MeshBuilder::addLeaves(int count, double leaf_m, const std::function<Eigen::Vector3d(SceneRandom&)>& draw,
                            SceneRandom& random) {
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d centre = draw(random);
    const Eigen::Vector3d u = randomDirection(random), v = u.cross(randomDirection(random)).normalized();
    const double half = 0.5 * leaf_m * random.uniform(0.7, 1.3);
    addTriangle(centre - half * u - half * v, centre + half * u - half * v, centre + half * 1.5 * v,
                SceneMaterial::LEAF);
  }
}

}  // namespace saw_ndt
