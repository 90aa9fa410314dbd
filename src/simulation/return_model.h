#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "saw_ndt/common/geometry.h"
#include "simulation/lidar_options.h"
#include "simulation/random_engine.h"
#include "simulation/ray_caster.h"

namespace saw_ndt {

/// What the rays of one beam met during one turn, by rising azimuth.
struct RingHits {
  double firing_offset = 0.0;  ///< azimuth of the first firing in steps from one firing to the next, 0 to 1
  std::vector<Eigen::Vector3f> directions;  ///< LiDAR frame
  std::vector<RayHit> hits;                 ///< normals in the LiDAR frame
};

/// The points of one beam and their SemanticKITTI classes.
struct RingReturns {
  std::vector<LidarPoint> points;
  std::vector<std::uint16_t> semantic_classes;
};

/// What a LiDAR makes of the surfaces that its rays meet: which returns it detects, at which range and how bright.
///
/// The received power of a surface with reflectivity rho at range r, hit at angle theta off its normal, is
///   rho (cos theta + b sin^2 theta) / r^2,
/// where b is the share that facets which face the LiDAR send back from a rough surface (Oren and Nayar, light and view
/// from the same direction). It fluctuates, and a return is detected above a threshold.
class ReturnModel {
 public:
  ReturnModel(const LidarOptions& options, const std::vector<Material>& materials);

  /// Stands for the vehicle itself in RayHit::material: of it nothing comes back.
  std::uint16_t ownVehicleMaterial() const { return static_cast<std::uint16_t>(materials_.size() - 1); }

  /// The returns of ring number `ring` of a scan; the rings above and below it are looked at for steps in range.
  void measure(const std::vector<RingHits>& rings, int ring, RandomEngine& random, RingReturns* returns) const;

 private:
  /// What comes back from a ray: of one surface, or of two that the footprint of the beam lies on.
  struct Echo {
    float range_m = 0.0F;
    float power = 0.0F;       ///< relative to the threshold; 0: nothing comes back
    float brightness = 0.0F;  ///< reflectivity times what the angle leaves of it
    std::uint16_t material = 0;
  };
  struct Neighbour {
    const RingHits* ring;
    std::size_t firing;
    float spacing_rad;
  };

  Echo echoOf(const RayHit& hit, const Eigen::Vector3f& direction) const;
  Echo mixed(const Echo& own, const Echo& other, float share_of_other) const;
  bool isEdge(const RayHit& own, const Eigen::Vector3f& own_direction, const RayHit& other,
              const Eigen::Vector3f& other_direction) const;
  Echo echoAt(const RingHits& own, std::size_t firing, const Neighbour* neighbours, std::size_t neighbour_count,
              RandomEngine& random) const;

  LidarOptions options_;
  std::vector<Material> materials_;
  std::vector<double> range_offsets_m_;
  float aslant_share_;        ///< b
  float power_of_threshold_;  ///< as above, m^-2
};

}  // namespace saw_ndt
