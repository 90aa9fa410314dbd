#pragma once

#include <cstddef>
#include <cstdint>

#include "segmentation/component_filter.h"

namespace saw_ndt::internal {

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

/// Writes the column of each bit that is set, in rising order, and `added` to it. Returns how many there are.
std::size_t columnsOfBits(std::size_t words, const std::uint64_t* bits, std::uint16_t added, std::uint16_t* columns);

/// A row as words of 64 pixels, one bit each.
struct RowBits {
  const std::uint64_t* starts;      ///< whether a run begins there
  const std::uint64_t* joined;      ///< whether the run of the pixel before it goes on there
  const std::int32_t* runs_before;  ///< number of the first run that begins in each word or after it
};

/// Writes the pairs of runs of a row and of the one above that are connected, most of them once. Returns how many there
/// are, at most the number of pixels.
std::size_t pairsOfRuns(std::size_t words, const RowBits& row, const RowBits& above, const std::uint64_t* linked_above,
                        RunPair* pairs);

/// NonGround where the bit of `kept` is set, else Ground where `ground` is 1, else Noise.
void labelPixels(std::size_t count, const std::uint8_t* ground, const std::uint64_t* kept, StructuralLabel* labels);

}  // namespace saw_ndt::internal
