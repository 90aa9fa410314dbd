#include "io/pcd_ascii.h"

#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string_view>

#include "io/number_lines.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

namespace {

constexpr std::string_view kBlanks = " \t\r\f\v";

std::vector<std::string_view> wordsOf(std::string_view text) {
  std::vector<std::string_view> words;
  for (std::size_t first = text.find_first_not_of(kBlanks); first != std::string_view::npos;
       first = text.find_first_not_of(kBlanks)) {
    text.remove_prefix(first);
    words.push_back(text.substr(0, text.find_first_of(kBlanks)));
    text.remove_prefix(words.back().size());
  }
  return words;
}

template <typename Number>
std::optional<Number> parsed(std::string_view word) {
  if (word.size() > 1 && word.front() == '+') word.remove_prefix(1);
  Number number{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return number;
}

template <typename Number>
bool storeNumber(std::string_view word, unsigned char* to) {
  std::optional<Number> number;
  if constexpr (std::is_floating_point_v<Number>) {
    const std::optional<double> value = parsed<double>(word);
    if (value) number = static_cast<Number>(*value);
  } else {
    number = parsed<Number>(word);
    if (!number) {  // as in 3.0 or 1e3
      const double value = parsed<double>(word).value_or(0.5);
      constexpr double kGreatest = 9007199254740992.0;  // whole numbers are exact up to it
      const bool fits = std::abs(value) <= kGreatest &&
                        value >= static_cast<double>(std::numeric_limits<Number>::min()) &&
                        value <= static_cast<double>(std::numeric_limits<Number>::max());
      if (fits && value == std::floor(value)) number = static_cast<Number>(value);
    }
  }
  if (!number) return false;
  std::memcpy(to, &*number, sizeof(Number));
  return true;
}

bool storeAs(const PcdField& field, std::string_view word, unsigned char* to) {
  const bool is_signed = field.type == 'I';
  switch (field.size) {
    case 1:
      return is_signed ? storeNumber<std::int8_t>(word, to) : storeNumber<std::uint8_t>(word, to);
    case 2:
      return is_signed ? storeNumber<std::int16_t>(word, to) : storeNumber<std::uint16_t>(word, to);
    case 4:
      if (field.type == 'F') return storeNumber<float>(word, to);
      return is_signed ? storeNumber<std::int32_t>(word, to) : storeNumber<std::uint32_t>(word, to);
    default:
      if (field.type == 'F') return storeNumber<double>(word, to);
      return is_signed ? storeNumber<std::int64_t>(word, to) : storeNumber<std::uint64_t>(word, to);
  }
}

}  // namespace

PcdAsciiRows::PcdAsciiRows(const std::filesystem::path& path, const PcdHeader& header, std::istream& stream)
    : path_(path), header_(header), stream_(stream), line_number_(header.lines) {
  for (const PcdField& field : header.fields) values_ += field.count;
}

std::vector<unsigned char> PcdAsciiRows::read(std::uint64_t points) {
  const std::uint64_t point_bytes = header_.pointBytes();
  std::vector<unsigned char> bytes(points * point_bytes);
  unsigned char* at = bytes.data();
  for (std::uint64_t point = 0; point < points; ++point, ++points_read_, at += point_bytes) {
    if (!nextLine()) {
      throw Error(
          path_.string(), "",
          "is damaged: it holds " + std::to_string(points_read_) + " of " + std::to_string(header_.points) + " points");
    }
    store(at);
  }
  return bytes;
}

void PcdAsciiRows::requireEnd() {
  if (header_.others_follow || !nextLine()) return;
  refuse("more points than the " + std::to_string(header_.points) + " announced");
}

bool PcdAsciiRows::nextLine() {
  while (std::getline(stream_, line_)) {
    ++line_number_;
    if (line_.find_first_not_of(kBlanks) != std::string::npos) return true;
  }
  return false;
}

void PcdAsciiRows::refuse(const std::string& reason) const {
  throw Error(path_.string(), linePlace(line_number_), reason);
}

void PcdAsciiRows::store(unsigned char* to) const {
  const std::vector<std::string_view> words = wordsOf(line_);
  if (words.size() != values_) {
    refuse(std::to_string(words.size()) + " numbers, where " + std::to_string(values_) + " are needed");
  }
  auto word = words.begin();
  for (const PcdField& field : header_.fields) {
    for (std::uint64_t i = 0; i < field.count; ++i, ++word, to += field.size) {
      if (field.name == "_" || storeAs(field, *word, to)) continue;
      refuse("'" + std::string(word->substr(0, 40)) + "' is no number of the field " + field.name + " (" +
             std::string(1, field.type) + " of " + std::to_string(field.size) + " bytes)");
    }
  }
}

std::vector<unsigned char> readPcdAscii(const std::filesystem::path& path, const PcdHeader& header,
                                        std::istream& stream) {
  PcdAsciiRows rows(path, header, stream);
  std::vector<unsigned char> bytes = rows.read(header.points);
  rows.requireEnd();
  return bytes;
}

}  // namespace saw_ndt::internal
