#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace saw_ndt::internal {

/// The value in the middle of others by size, of an even number the upper of the two; there must be one. Changes their
/// order.
template <typename Number>
Number middleValue(std::vector<Number>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace saw_ndt::internal
