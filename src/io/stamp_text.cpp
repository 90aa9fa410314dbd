#include "io/stamp_text.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <ctime>
#include <string>

#include "io/stamp_seconds.h"

namespace saw_ndt::internal {

namespace {

constexpr std::string_view kDigits = "0123456789";
constexpr std::size_t kNanosecondDigits = 9;

std::optional<std::int64_t> wholeNumber(std::string_view digits) {
  std::int64_t value = 0;
  if (digits.empty() || digits.find_first_not_of(kDigits) != std::string_view::npos) return std::nullopt;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc()) return std::nullopt;
  return value;
}

/// Nanoseconds of the digits behind a decimal point.
std::optional<std::int64_t> nanostampSeconds(std::string_view digits) {
  std::string nine(digits.substr(0, kNanosecondDigits));
  if (digits.find_first_not_of(kDigits) != std::string_view::npos) return std::nullopt;
  nine.resize(kNanosecondDigits, '0');
  return wholeNumber(nine);
}

}  // namespace

std::optional<double> stampOfDate(std::string_view text) {
  // Places of the numbers of YYYY-MM-DD hh:mm:ss, and what stands behind each.
  struct Part {
    std::size_t first, digits;
    std::string_view ends;
    std::int64_t least, greatest;
  };
  constexpr Part kParts[] = {{0, 4, "-", 1900, 9999}, {5, 2, "-", 1, 12},  {8, 2, " T", 1, 31},
                             {11, 2, ":", 0, 23},     {14, 2, ":", 0, 59}, {17, 2, ".Z", 0, 60}};
  std::int64_t numbers[6];
  for (int i = 0; i < 6; ++i) {
    const Part& part = kParts[i];
    if (text.size() < part.first + part.digits) return std::nullopt;
    const std::optional<std::int64_t> number = wholeNumber(text.substr(part.first, part.digits));
    if (!number || *number < part.least || *number > part.greatest) return std::nullopt;
    numbers[i] = *number;
    const std::size_t end = part.first + part.digits;
    if (i == 5 && end == text.size()) break;
    if (end >= text.size() || part.ends.find(text[end]) == std::string_view::npos) return std::nullopt;
  }
  std::string_view fraction = text.substr(std::min<std::size_t>(text.size(), 19));
  if (!fraction.empty() && fraction.back() == 'Z') fraction.remove_suffix(1);
  if (!fraction.empty()) fraction.remove_prefix(1);
  const std::optional<std::int64_t> nanoseconds = nanostampSeconds(fraction);
  if (!nanoseconds) return std::nullopt;
  std::tm date{};
  date.tm_year = static_cast<int>(numbers[0]) - 1900;
  date.tm_mon = static_cast<int>(numbers[1]) - 1;
  date.tm_mday = static_cast<int>(numbers[2]);
  date.tm_hour = static_cast<int>(numbers[3]);
  date.tm_min = static_cast<int>(numbers[4]);
  date.tm_sec = static_cast<int>(numbers[5]);
  return stampSeconds(timegm(&date), *nanoseconds);
}

std::optional<double> stampOfName(std::string_view stem) {
  const std::size_t first = stem.find_first_of(kDigits);
  if (first == std::string_view::npos) return std::nullopt;
  stem.remove_prefix(first);
  const std::string_view whole = stem.substr(0, stem.find_first_not_of(kDigits));
  const std::string_view rest = stem.substr(whole.size());
  const std::optional<std::int64_t> number = wholeNumber(whole);
  if (!number) return std::nullopt;
  if (!rest.empty()) {
    const std::optional<std::int64_t> nanoseconds = nanostampSeconds(rest.substr(1));
    const bool is_pair = (rest.front() == '_' || rest.front() == '-') && rest.size() == 1 + kNanosecondDigits;
    if (!nanoseconds || rest.size() == 1 || (rest.front() != '.' && !is_pair)) return std::nullopt;
    return stampSeconds(*number, *nanoseconds);
  }
  switch (whole.size()) {
    case 10:
      return static_cast<double>(*number);
    case 13:
      return stampSeconds(*number / 1000, *number % 1000 * 1000000);
    case 16:
      return stampSeconds(*number / 1000000, *number % 1000000 * 1000);
    case 19:
      return stampSeconds(*number / 1000000000, *number % 1000000000);
    default:
      return std::nullopt;
  }
}

}  // namespace saw_ndt::internal
