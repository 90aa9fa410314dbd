#include "simulation/scene.h"

namespace saw_ndt {

void append(const TriangleMesh& part, TriangleMesh& whole) {
  const auto first = static_cast<std::uint32_t>(whole.vertices.size());
  whole.vertices.insert(whole.vertices.end(), part.vertices.begin(), part.vertices.end());
  for (const auto& [a, b, c] : part.triangles) whole.triangles.push_back({first + a, first + b, first + c});
  whole.materials.insert(whole.materials.end(), part.materials.begin(), part.materials.end());
}

}  // namespace saw_ndt
