#pragma once

#include <pcl/types.h>

#include <cstddef>
#include <stdexcept>
#include <string>

namespace saw_ndt {
namespace internal {

/// PCL itself does not look at indices. @throws std::out_of_range where one is of no point of a cloud of `size` points
inline void requireIndicesWithin(const pcl::Indices& indices, std::size_t size) {
  for (const pcl::index_t index : indices) {
    if (index >= 0 && static_cast<std::size_t>(index) < size) continue;
    throw std::out_of_range("index " + std::to_string(index) + " of a cloud of " + std::to_string(size) + " points");
  }
}

}  // namespace internal
}  // namespace saw_ndt
