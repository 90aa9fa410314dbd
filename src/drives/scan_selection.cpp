#include "saw_ndt/drives/scan_selection.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <stdexcept>
#include <string_view>

namespace saw_ndt {

namespace {

[[noreturn]] void refuse(const std::string& text, const std::string& reason) {
  throw std::invalid_argument("scan selection '" + text + "': " + reason);
}

std::optional<long long> parsePart(const std::string& text, std::string_view part) {
  if (part.empty()) return std::nullopt;
  long long value = 0;
  const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
  if (error != std::errc() || end != part.data() + part.size()) {
    refuse(text, "must be first:last:step or one scan number");
  }
  return value;
}

std::vector<std::string_view> splitAtColons(std::string_view text) {
  std::vector<std::string_view> parts;
  for (std::size_t colon = text.find(':'); colon != std::string_view::npos; colon = text.find(':')) {
    parts.push_back(text.substr(0, colon));
    text.remove_prefix(colon + 1);
  }
  parts.push_back(text);
  return parts;
}

}  // namespace

std::vector<int> parseScanSelection(const std::string& text, int scan_count) {
  const std::vector<std::string_view> parts = splitAtColons(text);
  if (text.empty() || parts.size() > 3) refuse(text, "must be first:last:step or one scan number");
  const std::string nothing = "selects none of " + std::to_string(scan_count) + " scans";

  if (parts.size() == 1) {
    const long long number = *parsePart(text, parts[0]);
    if (number < -static_cast<long long>(scan_count) || number >= scan_count) refuse(text, nothing);
    return {static_cast<int>(number < 0 ? number + scan_count : number)};
  }

  // Larger steps select the same scans; the limit keeps first + step from overflowing.
  const long long step_limit = static_cast<long long>(scan_count) + 1;
  const long long step =
      std::clamp(parts.size() == 3 ? parsePart(text, parts[2]).value_or(1) : 1LL, -step_limit, step_limit);
  if (step == 0) refuse(text, "the step must not be 0");
  // The range of a bound that Python's slice.indices() clamps to: a backward slice may end before the first scan.
  const long long lowest = step > 0 ? 0 : -1;
  const long long highest = step > 0 ? scan_count : scan_count - 1LL;
  const auto bound = [&](std::string_view part, long long omitted) {
    const std::optional<long long> value = parsePart(text, part);
    if (!value) return omitted;
    return std::clamp(*value < 0 ? *value + scan_count : *value, lowest, highest);
  };
  const long long first = bound(parts[0], step > 0 ? lowest : highest);
  const long long last = bound(parts[1], step > 0 ? highest : lowest);

  std::vector<int> scans;
  for (long long scan = first; step > 0 ? scan < last : scan > last; scan += step) {
    scans.push_back(static_cast<int>(scan));
  }
  if (scans.empty()) refuse(text, nothing);
  return scans;
}

std::vector<int> parseScanShard(const std::string& text, const std::vector<int>& selected) {
  const auto refuseShard = [&](const std::string& reason) {
    throw std::invalid_argument("shard '" + text + "': " + reason);
  };
  std::size_t shard = 0, shard_count = 0;
  const char* const end = text.data() + text.size();
  const auto [slash, error] = std::from_chars(text.data(), end, shard);
  const bool has_count = error == std::errc() && slash != end && *slash == '/';
  if (!has_count) refuseShard("must be I/N, I from 1 to N");
  const auto [last, count_error] = std::from_chars(slash + 1, end, shard_count);
  if (count_error != std::errc() || last != end || shard < 1 || shard > shard_count) {
    refuseShard("must be I/N, I from 1 to N");
  }
  if (shard > selected.size()) refuseShard("has none of " + std::to_string(selected.size()) + " scans");
  std::vector<int> scans;
  for (std::size_t i = shard - 1; i < selected.size(); i += std::min(shard_count, selected.size())) {
    scans.push_back(selected[i]);
  }
  return scans;
}

}  // namespace saw_ndt
