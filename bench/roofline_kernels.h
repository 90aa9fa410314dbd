#pragma once

#include <cstddef>
#include <cstdint>

namespace saw_ndt {

// What a core can do at most, for each instruction set, as loops over single-precision vectors that do nothing else.
// Each returns a value that depends on all that it did.

/// Multiply-adds: `rounds` times 12 vectors. Sets `operations` to the number of floating-point operations.
float multiplyAdd(std::size_t rounds, double& operations);
/// Reads `count` values, a multiple of 128.
float readValues(const float* values, std::size_t count);
/// Gathers table[indices[i]] for i < count, a multiple of 128.
float gatherValues(const float* table, const std::int32_t* indices, std::size_t count);
/// Reads `count` values, a multiple of 128, and adds each, spread over a vector, with a factor.
float broadcastValues(const float* values, std::size_t count);

}  // namespace saw_ndt
