#pragma once

#include <cstddef>
#include <cstdint>

namespace saw_ndt::internal {

// States of a pixel while ground grows, each implying those before it. Doubtful: near the profile, yet too steep a step
// from the last ground return, or the foot of an obstacle.
constexpr std::uint8_t kReturnState = 1;
constexpr std::uint8_t kDoubtfulState = 2;
constexpr std::uint8_t kGroundState = 3;

struct GrowthLimits {
  float slope;
  float step_tolerance;
  float profile_tolerance;
};

/// One row of a range image, and what has been found so far below it; see GroundDetection. All arrays begin with the
/// same column.
struct GrowingRow {
  const float* range;
  const float* horizontal_range;
  const float* height;
  float* last_range;
  float* last_height;
  float* profile_height;
  std::uint8_t* states;
};

struct FootLimits {
  float slope;          ///< least slope of the line from a foot up to its obstacle
  float rise;           ///< greatest height of the obstacle above its foot, and how much of it counts for the slope
  float rise_of_range;  ///< that much higher it may be for each metre of range
};

/// One row of a range image, and the lowest obstacle above it in each column: what has a return and is not sure to be
/// ground; see GroundDetection. All arrays begin with the same column.
struct FootRow {
  const float* horizontal_range;
  const float* height;
  float* obstacle_range;
  float* obstacle_height;
  std::uint8_t* states;
};

// The same bits for every instruction set.

/// Lets ground grow by one row in some columns.
void growRow(std::size_t columns, const GrowthLimits& limits, const GrowingRow& row);

/// Makes ground of a row doubtful that is the foot of the obstacle above it, and goes on to the obstacles above the row
/// below.
void doubtFeet(std::size_t columns, const FootLimits& limits, const FootRow& row);

/// How many of three pixels one above the other have returns, and how many are ground.
void sumColumns(std::size_t columns, const std::uint8_t* above, const std::uint8_t* middle, const std::uint8_t* below,
                std::uint8_t* returns, std::uint8_t* ground);

/// Ground stays where half of the eight neighbours that have returns are ground; what is doubtful joins where more than
/// three quarters are. The sums have one column more at either side.
void settleRow(std::size_t columns, const std::uint8_t* states, const std::uint8_t* returns, const std::uint8_t* ground,
               std::uint8_t* result);

}  // namespace saw_ndt::internal
