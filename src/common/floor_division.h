#pragma once

namespace saw_ndt::internal {

/// The quotient rounded down, also of negative values. @param divisor  positive
inline int floorDivided(int value, int divisor) { return value / divisor - static_cast<int>(value % divisor < 0); }

}  // namespace saw_ndt::internal
