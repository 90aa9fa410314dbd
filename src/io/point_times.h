#pragma once

#include <cstdint>
#include <vector>

#include "saw_ndt/common/scan_view.h"

namespace saw_ndt::internal {

/// Makes seconds of the times of a scan's points, in place, and empties them where they are all the same or not known.
///
/// The unit is told from the span of the times of returns, for a scan takes 0.01 to 1.5 s: then from their size, as
/// times since 1970. Where neither says, floating-point numbers are seconds, and whole ones of the unit that makes the
/// span most like a scan's.
void makeSeconds(std::vector<double>& times, const std::vector<LidarPoint>& points, bool whole_numbers);

/// Keeps the ring numbers of a scan's points where they are whole numbers from 0 to `greatest` and not all the same.
/// What points that are no returns have does not matter; they get ring 0 where theirs is none.
/// @return empty where these are no rings
std::vector<std::uint16_t> ringsFrom(const std::vector<double>& numbers, const std::vector<LidarPoint>& points,
                                     double greatest);

}  // namespace saw_ndt::internal
