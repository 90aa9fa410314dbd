#pragma once

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_int_distribution.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <cstdint>

#include "simulation/scene_description.h"

namespace saw_ndt {

/// A seed made of several numbers, each of which changes every bit (the finalizer of SplitMix64).
template <typename... Numbers>
std::uint64_t mixedSeed(Numbers... numbers) {
  std::uint64_t mixed = 0;
  for (const std::uint64_t number : {static_cast<std::uint64_t>(numbers)...}) {
    mixed += number + 0x9e3779b97f4a7c15u;
    mixed = (mixed ^ (mixed >> 30)) * 0xbf58476d1ce4e5b9u;
    mixed = (mixed ^ (mixed >> 27)) * 0x94d049bb133111ebu;
    mixed ^= mixed >> 31;
  }
  return mixed;
}

/// Draws for the making of scenes: the same numbers on every platform.
class SceneRandom {
 public:
  explicit SceneRandom(std::uint64_t seed) : engine_(seed) {}

  double uniform(double least, double greatest) {
    return least < greatest ? boost::random::uniform_real_distribution<double>(least, greatest)(engine_) : least;
  }
  double uniform(const ValueRange& range) { return uniform(range.min, range.max); }
  bool chance(double probability) { return uniform(0.0, 1.0) < probability; }
  std::size_t index(std::size_t count) {
    return boost::random::uniform_int_distribution<std::size_t>(0, count - 1)(engine_);
  }

 private:
  boost::random::mt19937_64 engine_;
};

}  // namespace saw_ndt
