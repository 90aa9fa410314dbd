#include "registration/line_search.h"

#include <algorithm>
#include <cmath>

namespace saw_ndt::internal {
namespace {

constexpr double kSufficientDecrease = 1e-4;
constexpr double kFlattening = 0.9;

struct Trial {
  double step = 0.0;
  ValueAndSlope at;
};

// The minimizer of the cubic through two points with their slopes, `from` the one that it is reckoned from.
double cubicMinimizer(const Trial& from, const Trial& to) {
  const double span = to.step - from.step;
  const double z = 3.0 * (from.at.value - to.at.value) / span + from.at.slope + to.at.slope;
  const double discriminant = std::max(0.0, z * z - from.at.slope * to.at.slope);
  const double w = std::copysign(std::sqrt(discriminant), span);
  return from.step + span * (w - from.at.slope + z) / (to.at.slope - from.at.slope + 2.0 * w);
}

// The minimizer of the parabola with the value and slope of `from` and the value of `to`.
double quadraticMinimizer(const Trial& from, const Trial& to) {
  const double span = to.step - from.step;
  return from.step + 0.5 * span * from.at.slope / (from.at.slope - (to.at.value - from.at.value) / span);
}

// Where the slope vanishes if it changes evenly between the two.
double secantMinimizer(const Trial& from, const Trial& to) {
  return from.step - (from.step - to.step) / (from.at.slope - to.at.slope) * from.at.slope;
}

// The next trial by the four cases of Section 4 of the paper. `bracketed`: a minimizer is known to lie between lower
// and upper; otherwise there is no upper yet, and where the function only falls faster the longest step is tried.
double nextStep(const Trial& lower, const Trial& upper, const Trial& trial, bool bracketed, double max_step) {
  if (trial.step == lower.step) return trial.step;
  if (trial.at.value > lower.at.value) {
    const double cubic = cubicMinimizer(lower, trial);
    const double quadratic = quadraticMinimizer(lower, trial);
    return std::abs(cubic - lower.step) < std::abs(quadratic - lower.step) ? cubic : 0.5 * (cubic + quadratic);
  }
  if (trial.at.slope * lower.at.slope < 0.0) {
    const double cubic = cubicMinimizer(lower, trial);
    const double secant = secantMinimizer(lower, trial);
    return std::abs(cubic - trial.step) >= std::abs(secant - trial.step) ? cubic : secant;
  }
  if (std::abs(trial.at.slope) <= std::abs(lower.at.slope)) {
    const double cubic = cubicMinimizer(lower, trial);
    const double secant = secantMinimizer(lower, trial);
    const double nearer = std::abs(cubic - trial.step) < std::abs(secant - trial.step) ? cubic : secant;
    if (!bracketed) return nearer > trial.step ? nearer : max_step;
    const double bound = trial.step + 0.66 * (upper.step - trial.step);
    return trial.step > lower.step ? std::min(bound, nearer) : std::max(bound, nearer);
  }
  return bracketed ? cubicMinimizer(upper, trial) : max_step;
}

// Shrinks the interval of uncertainty; true when it has become a point.
bool updateInterval(Trial& lower, Trial& upper, const Trial& trial) {
  if (trial.at.value > lower.at.value) {
    upper = trial;
    return false;
  }
  const double towards = trial.at.slope * (lower.step - trial.step);
  if (towards == 0.0) return true;
  if (towards < 0.0) upper = lower;
  lower = trial;
  return false;
}

}  // namespace

double moreThuenteStep(const std::function<ValueAndSlope(double)>& function, const ValueAndSlope& at_zero,
                       double first_step, double min_step, double max_step, int max_trials) {
  // psi of the paper: the function less the decrease that is asked of it. Used until the interval is closed.
  const auto psi = [&at_zero](double step, const ValueAndSlope& at) {
    return ValueAndSlope{at.value - at_zero.value - kSufficientDecrease * at_zero.slope * step,
                         at.slope - kSufficientDecrease * at_zero.slope};
  };
  const auto back = [&at_zero](Trial& trial) {
    trial.at.value += at_zero.value + kSufficientDecrease * at_zero.slope * trial.step;
    trial.at.slope += kSufficientDecrease * at_zero.slope;
  };
  const auto clamped = [&](double step) { return std::max(min_step, std::min(step, max_step)); };

  Trial lower{0.0, psi(0.0, at_zero)}, upper = lower;
  double step = clamped(first_step);
  ValueAndSlope at = function(step);
  bool closed = false, bracketed = false;
  for (int trials = 0; trials < max_trials && min_step < max_step; ++trials) {
    const ValueAndSlope reduced = psi(step, at);
    if (reduced.value <= 0.0 && at.slope <= -kFlattening * at_zero.slope) break;
    if (!closed && reduced.value <= 0.0 && reduced.slope >= 0.0) {
      closed = true;
      back(lower);
      back(upper);
    }
    const Trial trial{step, closed ? at : reduced};
    const double next = clamped(nextStep(lower, upper, trial, bracketed, max_step));
    bracketed = bracketed || trial.at.value > lower.at.value || trial.at.slope * lower.at.slope < 0.0;
    if (updateInterval(lower, upper, trial) || !std::isfinite(next) || next == step) break;
    step = next;
    at = function(step);
  }
  return step;
}

}  // namespace saw_ndt::internal
