#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>

#include "simulation/scene.h"

namespace saw_ndt {

/// A ray through the scene.
struct Ray {
  Eigen::Vector3f origin;     ///< metres, scene frame
  Eigen::Vector3f direction;  ///< of length 1
  float time_share;           ///< when: 0 at the start of the span of RayCaster::setTimeSpan(), 1 at its end
};

/// Where a ray meets the first surface.
struct RayHit {
  float range_m = std::numeric_limits<float>::infinity();  ///< from the origin; infinite: it meets none
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();        ///< of length 1, scene frame, on the side of the origin
  std::uint16_t material = 0;                              ///< index into Scene::materials

  bool isHit() const { return range_m < std::numeric_limits<float>::infinity(); }
};

/// Finds what rays through a scene hit. What stands is prepared once, what moves for each span of time.
class RayCaster {
 public:
  /// Takes its own copy of what it needs of the scene. @throws std::invalid_argument that names the field and its
  /// index: an index out of range, other than one material a triangle, coordinates that are not finite, a transform
  /// that is not finite or not invertible, a moving object without a motion
  explicit RayCaster(const Scene& scene);
  ~RayCaster();
  RayCaster(RayCaster&&) noexcept;
  RayCaster& operator=(RayCaster&&) noexcept;

  /// Puts what moves where it is from one time (s) to another; in between, it moves in a straight line.
  /// @throws std::invalid_argument that names the object whose pose is not finite
  void setTimeSpan(double start_s, double end_s);

  /// The first surface within `max_range_m` on each of `count` rays. Neighbours in the list should be neighbours in
  /// direction: they are cast together. What moves is there from the first setTimeSpan() on. Threads may share a
  /// caster.
  void cast(const Ray* rays, std::size_t count, float max_range_m, RayHit* hits) const;

 private:
  class Embree;
  std::unique_ptr<Embree> embree_;
};

}  // namespace saw_ndt
