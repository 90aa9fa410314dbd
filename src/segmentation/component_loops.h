#pragma once

#include <cstddef>
#include <cstdint>

namespace saw_ndt {

/// How a pixel's range and that of a neighbour must compare for the two to be connected; see connected().
struct ConnectionRatios {
  float along;   ///< in a row
  float across;  ///< in a column
};

// What a pixel that may be part of a component has: a return that is no ground; a connection to the pixel before it in
// its row; one to the pixel above it.
constexpr std::uint8_t kActive = 1;
constexpr std::uint8_t kLinkedBefore = 2;
constexpr std::uint8_t kLinkedAbove = 4;

// The same bits for every instruction set.

/// Ranges with those of ground taken out.
void takeOutGround(std::size_t count, const float* range, const std::uint8_t* ground, float* obstacle_range);

/// The links of pixels with those before them in their row and those above them; `range` begins one pixel early.
void linkPixels(std::size_t count, const ConnectionRatios& ratios, const float* range, const float* above,
                std::uint8_t* links);

/// For each pixel a bit that tells whether it has a link, or another; 64 pixels a word.
void bitsOfLinks(std::size_t words, const std::uint8_t* links, std::uint64_t* active, std::uint64_t* linked_before,
                 std::uint64_t* linked_above);

}  // namespace saw_ndt
