#include "io/stamp_check.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <sstream>

#include "common/middle_value.h"

namespace saw_ndt::internal {

namespace {

// Scans and poses come every 0.02 to 20 s: a thousand between the units on either side.
constexpr double kLongestGap_s = 20.0;
constexpr double kFewestEqual = 3;
constexpr double kRoundedShare = 0.25;
constexpr double kRoundingTolerance = 1e-3;

// Where stamps are equal or fall: how often, and the first time.
struct Findings {
  std::size_t count = 0, first = 0;
  void add(std::size_t i) {
    if (count++ == 0) first = i;
  }
};

std::string textOf(double value) {
  std::ostringstream text;
  text.precision(12);
  text << value;
  return text.str();
}

std::string describe(const Findings& findings, const std::vector<double>& stamps_s, const std::string& what) {
  return std::to_string(findings.count) + " of " + std::to_string(stamps_s.size()) + " stamps " + what +
         ", the first of them number " + std::to_string(findings.first) + " from 0 (" +
         textOf(stamps_s[findings.first]) + " s)";
}

/// Whether many stamps are equal and all are multiples of the least difference.
bool lookRounded(const Findings& equal, double least_step_s, const std::vector<double>& stamps_s) {
  const auto count = static_cast<double>(equal.count);
  if (count < kFewestEqual || count < kRoundedShare * static_cast<double>(stamps_s.size())) return false;
  return std::all_of(stamps_s.begin(), stamps_s.end(), [&](double stamp_s) {
    const double steps = (stamp_s - stamps_s.front()) / least_step_s;
    return std::abs(steps - std::round(steps)) < kRoundingTolerance;
  });
}

/// The unit that stamps so far apart are probably in, and what to divide them by; empty where it is seconds.
std::string unitOf(double typical_gap) {
  if (typical_gap <= kLongestGap_s) return "";
  if (typical_gap <= 1e3 * kLongestGap_s) return "milliseconds: divide them by 1e3";
  if (typical_gap <= 1e6 * kLongestGap_s) return "microseconds: divide them by 1e6";
  return "nanoseconds: divide them by 1e9";
}

}  // namespace

std::vector<std::string> oddStamps(const std::vector<double>& stamps_s) {
  std::vector<double> steps_s;
  Findings equal, falling;
  for (std::size_t i = 1; i < stamps_s.size(); ++i) {
    const double step_s = stamps_s[i] - stamps_s[i - 1];
    if (step_s == 0.0) equal.add(i);
    if (step_s < 0.0) falling.add(i);
    if (step_s != 0.0) steps_s.push_back(std::abs(step_s));
  }
  std::vector<std::string> findings;
  if (!steps_s.empty()) {
    const double typical_step_s = middleValue(steps_s);
    const std::string unit = unitOf(typical_step_s);
    if (!unit.empty()) {
      findings.push_back("stamps are " + textOf(typical_step_s) + " apart, where seconds are needed; they may be " +
                         unit);
    }
    const double least_step_s = *std::min_element(steps_s.begin(), steps_s.end());
    if (lookRounded(equal, least_step_s, stamps_s)) {
      findings.push_back(describe(equal, stamps_s, "equal the one before") + ", and all are steps of " +
                         textOf(least_step_s) + " s: they seem to be rounded; give them more digits");
      equal.count = 0;
    }
  }
  if (equal.count > 0) {
    findings.push_back(describe(equal, stamps_s, "equal the one before") + "; give every scan its own time");
  }
  if (falling.count > 0) {
    findings.push_back(describe(falling, stamps_s, "lie before the one before them") +
                       "; scans and their stamps must be in the order of time");
  }
  return findings;
}

}  // namespace saw_ndt::internal
