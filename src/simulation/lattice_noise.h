#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>

#include "simulation/random_numbers.h"

namespace saw_ndt {

/// Smooth noise over the plane: independent values of unit variance at the corners of square cells, joined smoothly.
class LatticeNoise {
 public:
  /// @param cell_m  edge of a cell
  LatticeNoise(std::uint64_t seed, double cell_m) : seed_(seed), cell_m_(cell_m) {}

  double operator()(const Eigen::Vector2d& point) const {
    const Eigen::Array2d cell = (point.array() / cell_m_).floor();
    const Eigen::Array2d t = point.array() / cell_m_ - cell;
    const Eigen::Array2d s = t * t * (3.0 - 2.0 * t);
    const auto x = static_cast<std::int64_t>(cell.x()), y = static_cast<std::int64_t>(cell.y());
    const double low = (1.0 - s.x()) * corner(x, y) + s.x() * corner(x + 1, y);
    const double high = (1.0 - s.x()) * corner(x, y + 1) + s.x() * corner(x + 1, y + 1);
    return (1.0 - s.y()) * low + s.y() * high;
  }

 private:
  double corner(std::int64_t x, std::int64_t y) const {
    // Uniform over +-sqrt(3), whose variance is 1.
    const std::uint64_t bits = mixedSeed(seed_, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y));
    return std::sqrt(3.0) * (2.0 * static_cast<double>(bits >> 11) * 0x1p-53 - 1.0);
  }

  std::uint64_t seed_;
  double cell_m_;
};

}  // namespace saw_ndt
