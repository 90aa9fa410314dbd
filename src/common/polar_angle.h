#pragma once

#include "saw_ndt/common/geometry.h"

namespace saw_ndt::internal {

/// The angle of (x, y) from the x axis, 0 to 2 pi, to 2e-6 rad and without a branch, so that the compiler makes vector
/// code of a loop over it: it is part of the loop, whatever instruction set that is compiled for. Minimax polynomial of
/// the arc tangent on [0, 1] (Abramowitz and Stegun 4.4.49).
[[gnu::always_inline]] inline float polarAngle(float x, float y) {
  constexpr float kTurn = static_cast<float>(2.0 * kPi);
  constexpr float kMinNormalFloat = 1.175494351e-38F;
  const float absolute_x = __builtin_fabsf(x);
  const float absolute_y = __builtin_fabsf(y);
  const float greater = absolute_x < absolute_y ? absolute_y : absolute_x;
  const float smaller = absolute_y < absolute_x ? absolute_y : absolute_x;
  const float t = smaller / (greater < kMinNormalFloat ? kMinNormalFloat : greater);
  const float s = t * t;
  const float polynomial =
      1.0F +
      s * (-0.3333314528F +
           s * (0.1999355085F +
                s * (-0.1420889944F +
                     s * (0.1065626393F +
                          s * (-0.0752896400F + s * (0.0429096138F + s * (-0.0161657367F + s * 0.0028662257F)))))));
  float angle = t * polynomial;
  angle = absolute_y > absolute_x ? static_cast<float>(kPi / 2) - angle : angle;
  angle = x < 0.0F ? static_cast<float>(kPi) - angle : angle;
  return y < 0.0F ? kTurn - angle : angle;
}

}  // namespace saw_ndt::internal
