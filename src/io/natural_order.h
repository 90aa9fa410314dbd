#pragma once

#include <cctype>
#include <string>

namespace saw_ndt::internal {

/// Whether a name comes before another one where the numbers in them count as such: 9 before 10.
inline bool naturallyBefore(const std::string& a, const std::string& b) {
  const auto isDigit = [](char letter) { return std::isdigit(static_cast<unsigned char>(letter)) != 0; };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!isDigit(a[i]) || !isDigit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
      continue;
    }
    while (i < a.size() && a[i] == '0') ++i;
    while (j < b.size() && b[j] == '0') ++j;
    const std::size_t first_i = i, first_j = j;
    while (i < a.size() && isDigit(a[i])) ++i;
    while (j < b.size() && isDigit(b[j])) ++j;
    if (i - first_i != j - first_j) return i - first_i < j - first_j;
    const int order = a.compare(first_i, i - first_i, b, first_j, j - first_j);
    if (order != 0) return order < 0;
  }
  if (a.size() - i != b.size() - j) return a.size() - i < b.size() - j;
  return a < b;
}

}  // namespace saw_ndt::internal
