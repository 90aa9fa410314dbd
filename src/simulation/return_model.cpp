#include "simulation/return_model.h"

#include <algorithm>
#include <boost/random/exponential_distribution.hpp>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_01.hpp>
#include <cmath>
#include <stdexcept>

#include "saw_ndt/common/geometry.h"
#include "simulation/beam_constants.h"

namespace saw_ndt {
namespace {

constexpr std::uint16_t kOutlierClass = 1;        // of SemanticKITTI
constexpr float kGreatestReflectance = 0.99F;     // of KITTI's scans
constexpr float kReflectanceSteps = 100.0F;       // of which its reflectances are multiples
constexpr float kDropletReflectance = 0.05F;      // the brightest one
constexpr float kReflectivityOfReference = 0.1F;  // see LidarOptions::detection_range_m

// Oren and Nayar's A and B for facets whose slopes have the standard deviation s: B / A.
float aslantShare(double s) {
  const double squared = s * s;
  const double a = 1.0 - 0.5 * squared / (squared + 0.33);
  const double b = 0.45 * squared / (squared + 0.09);
  return static_cast<float>(b / a);
}

float reflectance(float brightness) {
  const float limited = std::min(brightness, kGreatestReflectance);
  return std::round(limited * kReflectanceSteps) / kReflectanceSteps;
}

}  // namespace

ReturnModel::ReturnModel(const LidarOptions& options, const std::vector<Material>& materials)
    : options_(options),
      materials_(materials),
      range_offsets_m_(beamConstants(options).range_offsets_m),
      aslant_share_(aslantShare(options.surface_roughness_rad)),
      power_of_threshold_(kReflectivityOfReference /
                          static_cast<float>(options.detection_range_m * options.detection_range_m)) {
  if (materials.size() > 65535) {
    throw std::invalid_argument("materials.size() = " + std::to_string(materials.size()) + ": must be at most 65535");
  }
  materials_.push_back({0, 0.0F});
}

ReturnModel::Echo ReturnModel::echoOf(const RayHit& hit, const Eigen::Vector3f& direction) const {
  Echo echo;
  if (!hit.isHit()) return echo;
  const float cosine = std::abs(hit.normal.dot(direction));
  echo.range_m = hit.range_m;
  echo.material = hit.material;
  echo.brightness = materials_[hit.material].reflectivity * (cosine + aslant_share_ * (1.0F - cosine * cosine));
  echo.power = echo.brightness / (hit.range_m * hit.range_m * power_of_threshold_);
  return echo;
}

bool ReturnModel::isEdge(const RayHit& own, const Eigen::Vector3f& own_direction, const RayHit& other,
                         const Eigen::Vector3f& other_direction) const {
  if (own.isHit() != other.isHit()) return true;
  if (!own.isHit()) return false;
  const auto step_m = static_cast<float>(options_.edge_step_m);
  if (std::abs(own.range_m - other.range_m) < step_m) return false;
  // A surface that runs on to the neighbour has no edge, however aslant it lies: one of the two tangent planes tells.
  const auto liesOn = [step_m](const RayHit& plane, const Eigen::Vector3f& plane_direction, const RayHit& point,
                               const Eigen::Vector3f& point_direction) {
    const float range_m = plane.range_m * plane.normal.dot(plane_direction) / plane.normal.dot(point_direction);
    return std::abs(range_m - point.range_m) < step_m;
  };
  return !liesOn(own, own_direction, other, other_direction) && !liesOn(other, other_direction, own, own_direction);
}

ReturnModel::Echo ReturnModel::mixed(const Echo& own, const Echo& other, float share_of_other) const {
  Echo a = own, b = other;
  a.power *= 1.0F - share_of_other;
  b.power *= share_of_other;
  a.brightness *= 1.0F - share_of_other;
  b.brightness *= share_of_other;
  Echo stronger = a.power >= b.power ? a : b;
  const bool merge = a.power > 0.0F && b.power > 0.0F && std::abs(a.range_m - b.range_m) < options_.pulse_length_m;
  if (!merge) return stronger;
  stronger.range_m = (a.power * a.range_m + b.power * b.range_m) / (a.power + b.power);
  stronger.power = a.power + b.power;
  stronger.brightness = a.brightness + b.brightness;
  return stronger;
}

ReturnModel::Echo ReturnModel::echoAt(const RingHits& own, std::size_t firing, const Neighbour* neighbours,
                                      std::size_t neighbour_count, RandomEngine& random) const {
  boost::random::uniform_01<float> uniform;
  const RayHit& hit = own.hits[firing];
  const Eigen::Vector3f& direction = own.directions[firing];
  const Echo echo = echoOf(hit, direction);
  const float radius_rad = 0.5F * static_cast<float>(options_.beam_divergence_rad);
  if (radius_rad == 0.0F) return echo;
  for (std::size_t i = 0; i < neighbour_count; ++i) {
    const Neighbour& neighbour = neighbours[i];
    const RayHit& other = neighbour.ring->hits[neighbour.firing];
    const Eigen::Vector3f& other_direction = neighbour.ring->directions[neighbour.firing];
    if (!isEdge(hit, direction, other, other_direction)) continue;
    // The edge lies anywhere between the two rays; beyond the footprint it changes nothing.
    const float edge_rad = uniform(random) * neighbour.spacing_rad;
    if (edge_rad >= radius_rad) continue;
    return mixed(echo, echoOf(other, other_direction), 0.5F * (1.0F - edge_rad / radius_rad));
  }
  return echo;
}

void ReturnModel::measure(const std::vector<RingHits>& rings, int ring, RandomEngine& random,
                          RingReturns* returns) const {
  boost::random::uniform_01<float> uniform;
  boost::random::normal_distribution<float> normal;
  boost::random::exponential_distribution<float> droplet_range_m(static_cast<float>(1.0 / options_.rain_mean_range_m));
  const auto dropout_share = static_cast<float>(options_.dropout_share);
  const auto rain_share = static_cast<float>(options_.rain_share);
  const auto power_fluctuation = static_cast<float>(options_.power_fluctuation);
  const auto range_noise_m = static_cast<float>(options_.range_noise_m);
  const auto range_offset_m = static_cast<float>(range_offsets_m_[ring]);

  const RingHits& own = rings[ring];
  const std::vector<double>& elevations_deg = options_.sensor.elevations_deg;
  const auto firings = static_cast<std::ptrdiff_t>(own.hits.size());
  const auto azimuth_spacing_rad =
      static_cast<float>(2.0 * kPi / static_cast<double>(firings) * std::cos(radiansFromDegrees(elevations_deg[ring])));
  // Rays beside the field of view are only what those at its edges have beside them.
  const double half_view = options_.field_of_view_deg / 720.0 * static_cast<double>(firings);

  const auto around = [firings](std::ptrdiff_t firing) {
    return static_cast<std::size_t>(firing < 0 ? firing + firings : firing >= firings ? firing - firings : firing);
  };
  struct Beside {
    const RingHits* ring;
    std::ptrdiff_t shift;
    float spacing_rad;
  };
  std::vector<Beside> beside = {{&own, -1, azimuth_spacing_rad}, {&own, 1, azimuth_spacing_rad}};
  for (const int row : {ring - 1, ring + 1}) {
    if (row < 0 || row >= static_cast<int>(rings.size())) continue;
    const std::ptrdiff_t shift = std::lround(own.firing_offset - rings[row].firing_offset);
    beside.push_back({&rings[row], shift,
                      static_cast<float>(radiansFromDegrees(std::abs(elevations_deg[row] - elevations_deg[ring])))});
  }

  returns->points.clear();
  returns->semantic_classes.clear();
  const auto add = [&](std::ptrdiff_t firing, float range_m, float brightness, std::uint16_t semantic_class) {
    LidarPoint point;
    positionOf(point) = own.directions[firing] * range_m;
    point.intensity = reflectance(brightness);
    returns->points.push_back(point);
    returns->semantic_classes.push_back(semantic_class);
  };
  for (std::ptrdiff_t firing = 0; firing < firings; ++firing) {
    if (static_cast<double>(std::min(firing, firings - firing)) > half_view) continue;
    if (rain_share > 0.0F && uniform(random) < rain_share) {
      const float range_m = droplet_range_m(random);
      if (range_m < own.hits[firing].range_m) {
        if (range_m >= options_.min_range_m && range_m <= options_.max_range_m) {
          add(firing, range_m, kDropletReflectance * uniform(random), kOutlierClass);
        }
        continue;
      }
    }
    Neighbour neighbours[4];
    for (std::size_t i = 0; i < beside.size(); ++i) {
      neighbours[i] = {beside[i].ring, around(firing + beside[i].shift), beside[i].spacing_rad};
    }
    const Echo echo = echoAt(own, static_cast<std::size_t>(firing), neighbours, beside.size(), random);
    if (echo.power <= 0.0F) continue;
    const float fluctuation = power_fluctuation > 0.0F ? std::exp(power_fluctuation * normal(random)) : 1.0F;
    if (echo.power * fluctuation <= 1.0F) continue;
    if (dropout_share > 0.0F && uniform(random) < dropout_share) continue;
    const float range_m =
        echo.range_m + range_offset_m + (range_noise_m > 0.0F ? range_noise_m * normal(random) : 0.0F);
    if (!(range_m >= options_.min_range_m && range_m <= options_.max_range_m)) continue;
    add(firing, range_m, echo.brightness * fluctuation, materials_[echo.material].semantic_class);
  }
}

}  // namespace saw_ndt
