#pragma once

#include <functional>

namespace saw_ndt::internal {

/// A function of one variable and its slope.
struct ValueAndSlope {
  double value = 0.0;
  double slope = 0.0;
};

/// Finds a step that lowers a function enough (f(a) <= f(0) + mu a f'(0), mu = 1e-4) and behind which it does not rise
/// too steeply (f'(a) <= nu |f'(0)|, nu = 0.9; that it may still fall steeply is PCL's reading, a bound on the step
/// ends such a descent), by the algorithm of More and Thuente, "Line search algorithms with guaranteed sufficient
/// decrease" (1994). Steps stay within [min_step, max_step]; at most `max_trials` after the first.
/// @param at_zero   value and slope at 0; the slope is negative
/// @return the last step tried; `function` was called there last
double moreThuenteStep(const std::function<ValueAndSlope(double)>& function, const ValueAndSlope& at_zero,
                       double first_step, double min_step, double max_step, int max_trials = 10);

}  // namespace saw_ndt::internal
