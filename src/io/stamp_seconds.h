#pragma once

#include <cstdint>

namespace saw_ndt::internal {

constexpr std::int64_t kNanosecondsPerSecond = 1000000000;

/// A stamp (s) of whole seconds and nanoseconds.
constexpr double stampSeconds(std::int64_t seconds, std::int64_t nanoseconds) {
  return static_cast<double>(seconds) + 1e-9 * static_cast<double>(nanoseconds);
}

/// A stamp (s) of nanoseconds.
constexpr double stampSeconds(std::int64_t nanoseconds) {
  return stampSeconds(nanoseconds / kNanosecondsPerSecond, nanoseconds % kNanosecondsPerSecond);
}

/// A stamp (ns) of ROS 1.
constexpr std::int64_t nanoseconds(std::uint32_t seconds, std::uint32_t nanoseconds) {
  return kNanosecondsPerSecond * seconds + nanoseconds;
}

}  // namespace saw_ndt::internal
