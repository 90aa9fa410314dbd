#pragma once

#include <cstddef>
#include <cstdint>

namespace saw_ndt::internal {

/// Columns along the edge of a tile of the index; a row of them is a word of 64 bits.
constexpr int kPlaceTileSize = 64;
/// Rows that are counted at once.
constexpr int kRowsAtOnce = 4;
/// A tile repeats the first rows of the next one, so that rows are read at once across its edge.
constexpr int kPlaceTileRows = kPlaceTileSize + kRowsAtOnce;
/// Layers of one metre above the ground.
constexpr int kPlaceLayers = 32;
/// One more, in which there is nothing, for offsets that fill up.
constexpr int kEmptyLayer = kPlaceLayers;
constexpr int kPlaceTileWords = (kPlaceLayers + 1) * kPlaceTileRows;

/// The tile around which cells are counted and its eight neighbours: word [layer * kPlaceTileRows + row] of each has a
/// bit for each column.
struct PlaceTables {
  const std::uint64_t* words[3][3];  ///< by y and x
};

/// A cell of a scan that has been turned by a heading, where it lies from the vehicle.
struct OutlineOffset {
  std::int16_t rows = 0;        ///< columns along y, -64 to 63
  std::uint8_t shift = 0;       ///< columns along x, modulo 64
  std::uint8_t tile_x = 0;      ///< 0: columns along x are negative; 1: they are not
  std::int32_t first_word = 0;  ///< of its layer
};

/// For the 64 x kRowsAtOnce places of some rows.
struct PlaceCounts {
  static constexpr int kPlanes = 9;
  std::uint64_t enough[kRowsAtOnce];          ///< a bit for each place whose count is not below the threshold
  std::uint64_t plane[kPlanes][kRowsAtOnce];  ///< bit k of the count of each place

  int count(int row, int column) const {
    int sum = 0;
    for (int k = 0; k < kPlanes; ++k) sum |= static_cast<int>((plane[k][row] >> column) & 1U) << k;
    return sum;
  }
};

/// The most offsets that can be counted.
constexpr std::size_t kMostOffsets = 504;

/// For the places of the rows from first_row on, counts how many cells of a scan that stands there meet their bit. A
/// place is a bit: 64 of them are added by each logical operation.
/// @param count      of offsets: a multiple of 8, at most kMostOffsets
/// @param allowed    a bit for each place that is asked for
/// @return whether any of these has a count of `threshold` or more; only then `counts` is filled in
bool countMatches(const PlaceTables& tables, const OutlineOffset* offsets, std::size_t count, int first_row,
                  int threshold, const std::uint64_t* allowed, PlaceCounts& counts);

}  // namespace saw_ndt::internal
