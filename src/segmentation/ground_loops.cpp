#include "segmentation/ground_loops.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "segmentation/ground_loops.cpp"
#include "common/vector_dispatch.h"

HWY_BEFORE_NAMESPACE();
namespace saw_ndt::internal {
namespace HWY_NAMESPACE {
namespace {

HWY_INLINE void growPixels(std::size_t columns, const GrowthLimits limits, const float* __restrict range,
                           const float* __restrict horizontal_range, const float* __restrict height,
                           float* __restrict last_range, float* __restrict last_height,
                           float* __restrict profile_height, std::uint8_t* __restrict states) {
  for (std::size_t column = 0; column < columns; ++column) {
    const float z = height[column];
    const float beyond = horizontal_range[column] - last_range[column];
    const float advance = beyond > 0.0F ? beyond : 0.0F;
    const float reach = limits.slope * advance;
    const float above_profile = z - profile_height[column];
    const float step = z - last_height[column];
    const int has_return = range[column] > 0.0F ? 1 : 0;
    const int near_profile = __builtin_fabsf(above_profile) <= limits.profile_tolerance + reach ? has_return : 0;
    const int is_ground = __builtin_fabsf(step) <= limits.step_tolerance + reach ? near_profile : 0;
    // The profile rises no faster than the slope, and falls at once: the lowest returns are the surest.
    const float rise = above_profile < reach ? above_profile : reach;
    last_range[column] += is_ground != 0 ? advance : 0.0F;
    last_height[column] = is_ground != 0 ? z : last_height[column];
    profile_height[column] += is_ground != 0 ? rise : 0.0F;
    states[column] = static_cast<std::uint8_t>(has_return + near_profile + is_ground);
  }
}

void growRowOfPixels(std::size_t columns, const GrowthLimits& limits, const GrowingRow& row) {
  growPixels(columns, limits, row.range, row.horizontal_range, row.height, row.last_range, row.last_height,
             row.profile_height, row.states);
}

HWY_INLINE void doubtFeetOfPixels(std::size_t columns, const FootLimits limits, const float* __restrict range,
                                  const float* __restrict height, float* __restrict obstacle_range,
                                  float* __restrict obstacle_height, std::uint8_t* __restrict states) {
  for (std::size_t column = 0; column < columns; ++column) {
    const float r = range[column];
    const float z = height[column];
    const float rise = obstacle_height[column] - z;
    const float least_rise = limits.slope * __builtin_fabsf(obstacle_range[column] - r);
    const float counted_rise = rise < limits.rise ? rise : limits.rise;
    const int is_close = rise <= limits.rise + limits.rise_of_range * r ? 1 : 0;
    const int is_foot = counted_rise >= least_rise ? is_close : 0;
    const int grown = states[column];
    const int state = grown == kGroundState ? kGroundState - is_foot : grown;
    const bool is_obstacle = (state == kReturnState) | (state == kDoubtfulState);
    obstacle_range[column] = is_obstacle ? r : obstacle_range[column];
    obstacle_height[column] = is_obstacle ? z : obstacle_height[column];
    states[column] = static_cast<std::uint8_t>(state);
  }
}

void doubtFeetOfRow(std::size_t columns, const FootLimits& limits, const FootRow& row) {
  doubtFeetOfPixels(columns, limits, row.horizontal_range, row.height, row.obstacle_range, row.obstacle_height,
                    row.states);
}

HWY_INLINE std::uint8_t is(bool condition) { return static_cast<std::uint8_t>(condition ? 1 : 0); }

void sumPixels(std::size_t columns, const std::uint8_t* __restrict above, const std::uint8_t* __restrict middle,
               const std::uint8_t* __restrict below, std::uint8_t* __restrict returns,
               std::uint8_t* __restrict ground) {
  for (std::size_t column = 0; column < columns; ++column) {
    returns[column] = static_cast<std::uint8_t>(is(above[column] >= kReturnState) + is(middle[column] >= kReturnState) +
                                                is(below[column] >= kReturnState));
    ground[column] = static_cast<std::uint8_t>(is(above[column] == kGroundState) + is(middle[column] == kGroundState) +
                                               is(below[column] == kGroundState));
  }
}

void settlePixels(std::size_t columns, const std::uint8_t* __restrict states, const std::uint8_t* __restrict returns,
                  const std::uint8_t* __restrict ground, std::uint8_t* __restrict result) {
  for (std::size_t column = 0; column < columns; ++column) {
    const std::uint8_t is_ground = is(states[column] == kGroundState);
    const std::uint8_t is_doubtful = is(states[column] == kDoubtfulState);
    const auto neighbours = static_cast<std::uint8_t>(returns[column] + returns[column + 1] + returns[column + 2] - 1);
    const auto of_ground =
        static_cast<std::uint8_t>(ground[column] + ground[column + 1] + ground[column + 2] - is_ground);
    const std::uint8_t stays = static_cast<std::uint8_t>(2 * of_ground) >= neighbours ? is_ground : std::uint8_t{0};
    const std::uint8_t joins = static_cast<std::uint8_t>(4 * of_ground) > static_cast<std::uint8_t>(3 * neighbours)
                                   ? is_doubtful
                                   : std::uint8_t{0};
    result[column] = stays | joins;
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace saw_ndt::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace saw_ndt::internal {

HWY_EXPORT(growRowOfPixels);
HWY_EXPORT(doubtFeetOfRow);
HWY_EXPORT(sumPixels);
HWY_EXPORT(settlePixels);

void growRow(std::size_t columns, const GrowthLimits& limits, const GrowingRow& row) {
  SAW_NDT_DISPATCH(growRowOfPixels)(columns, limits, row);
}

void doubtFeet(std::size_t columns, const FootLimits& limits, const FootRow& row) {
  SAW_NDT_DISPATCH(doubtFeetOfRow)(columns, limits, row);
}

void sumColumns(std::size_t columns, const std::uint8_t* above, const std::uint8_t* middle, const std::uint8_t* below,
                std::uint8_t* returns, std::uint8_t* ground) {
  SAW_NDT_DISPATCH(sumPixels)(columns, above, middle, below, returns, ground);
}

void settleRow(std::size_t columns, const std::uint8_t* states, const std::uint8_t* returns, const std::uint8_t* ground,
               std::uint8_t* result) {
  SAW_NDT_DISPATCH(settlePixels)(columns, states, returns, ground, result);
}

}  // namespace saw_ndt::internal
#endif
