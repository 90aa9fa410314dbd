#pragma once

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/seed_seq.hpp>
#include <cstdint>
#include <initializer_list>
#include <vector>

namespace saw_ndt {

/// Boost's engines and distributions, unlike those of the standard library's distributions, give the same numbers with
/// every compiler.
using RandomEngine = boost::random::mt19937;

/// An engine of its own for each list of keys, such as seed, scan and ring.
inline RandomEngine seededEngine(std::initializer_list<std::uint64_t> keys) {
  std::vector<std::uint32_t> words;
  for (const std::uint64_t key : keys) {
    words.push_back(static_cast<std::uint32_t>(key));
    words.push_back(static_cast<std::uint32_t>(key >> 32U));
  }
  boost::random::seed_seq sequence(words.begin(), words.end());
  return RandomEngine(sequence);
}

}  // namespace saw_ndt
