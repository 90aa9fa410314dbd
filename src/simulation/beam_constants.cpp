#include "simulation/beam_constants.h"

#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_01.hpp>

#include "simulation/random_engine.h"

namespace saw_ndt {
namespace {

// FNV-1a, 64 bits.
std::uint64_t hashOf(const std::string& text) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char letter : text) hash = (hash ^ static_cast<unsigned char>(letter)) * 1099511628211ULL;
  return hash;
}

}  // namespace

BeamConstants beamConstants(const LidarOptions& options) {
  RandomEngine random = seededEngine({hashOf(options.sensor.name)});
  boost::random::uniform_01<double> uniform;
  boost::random::normal_distribution<double> normal;
  BeamConstants constants;
  for (int ring = 0; ring < options.sensor.rows(); ++ring) {
    constants.firing_offsets.push_back(uniform(random));
    constants.range_offsets_m.push_back(options.beam_range_offset_m * normal(random));
  }
  return constants;
}

}  // namespace saw_ndt
