#include "io/csv_trajectory.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <string>

#include "io/rigid_transform.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

namespace {

constexpr std::array kQuantities = {"stamp", "x", "y", "z", "qx", "qy", "qz", "qw"};
constexpr std::size_t kCount = kQuantities.size();

/// Which column each of kQuantities is in.
struct Columns {
  std::array<std::size_t, kCount> at{};
  std::optional<double> seconds_in_unit;  ///< of the stamps, where the unit is named
  std::size_t cells = kCount;             ///< that a line has
};

struct ColumnName {
  std::vector<std::string> words;
  std::string unit;
};

bool isOneOf(const std::string& word, std::initializer_list<const char*> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// The words of a name, and the unit that is in brackets or its last word.
ColumnName columnName(const std::string& name) {
  ColumnName result;
  std::string word;
  bool in_brackets = false;
  const auto endWord = [&] {
    if (!word.empty()) (in_brackets ? result.unit : result.words.emplace_back()) = word;
    word.clear();
  };
  for (const char c : name) {
    const auto character = static_cast<unsigned char>(c);
    if (std::isalnum(character) != 0) {
      word += static_cast<char>(std::tolower(character));
      continue;
    }
    endWord();
    if (c == '[' || c == '(') in_brackets = true;
  }
  endWord();
  if (result.unit.empty() && result.words.size() > 1 &&
      isOneOf(result.words.back(), {"s", "sec", "secs", "seconds", "ms", "us", "ns", "nsec", "m", "mm"})) {
    result.unit = result.words.back();
    result.words.pop_back();
  }
  return result;
}

/// The place in kQuantities of what a column holds; nothing for a column that is not needed.
std::optional<std::size_t> quantityOf(const ColumnName& name) {
  if (name.words.empty()) return std::nullopt;
  const std::string& first = name.words.front();
  const std::string& last = name.words.back();
  if (name.words.size() == 1 && isOneOf(last, {"stamp", "timestamp", "time", "t"})) return 0;
  const char axis = last.back();
  if (axis < 'w' || axis > 'z' || last.size() > 2) return std::nullopt;
  const std::size_t place = axis == 'w' ? 3 : static_cast<std::size_t>(axis - 'x');
  const std::string kind = last.size() == 2 ? last.substr(0, 1) : name.words.size() > 1 ? first : "p";
  const auto has = [&](std::initializer_list<const char*> words) {
    return isOneOf(kind, words) || std::any_of(name.words.begin(), name.words.end(), [&](const std::string& word) {
             return word.size() > 3 && isOneOf(word, words);
           });
  };
  if (has({"q", "quat", "quaternion", "orientation", "rotation"})) return 4 + place;
  if (axis != 'w' && has({"p", "pos", "position", "t", "translation"})) return 1 + place;
  return std::nullopt;
}

std::optional<double> secondsIn(const CsvTable& table, const std::string& unit) {
  if (unit.empty()) return std::nullopt;
  if (isOneOf(unit, {"s", "sec", "secs", "seconds"})) return 1.0;
  if (unit == "ms") return 1e-3;
  if (unit == "us") return 1e-6;
  if (isOneOf(unit, {"ns", "nsec"})) return 1e-9;
  throw Error(table.path.string(), "", "stamps in '" + unit + "', where s, ms, us or ns is needed");
}

Columns namedColumns(const CsvTable& table) {
  Columns columns;
  columns.cells = table.names.size();
  std::array<bool, kCount> found{};
  for (std::size_t i = 0; i < table.names.size(); ++i) {
    const ColumnName name = columnName(table.names[i]);
    const std::optional<std::size_t> quantity = quantityOf(name);
    if (!quantity) continue;
    if (found[*quantity]) {
      throw Error(table.path.string(), "",
                  "the columns '" + table.names[columns.at[*quantity]] + "' and '" + table.names[i] + "' may both be " +
                      kQuantities[*quantity]);
    }
    found[*quantity] = true;
    columns.at[*quantity] = i;
    if (*quantity == 0) columns.seconds_in_unit = secondsIn(table, name.unit);
    if (*quantity >= 1 && *quantity <= 3 && !isOneOf(name.unit, {"", "m"})) {
      throw Error(table.path.string(), "", "the column '" + table.names[i] + "' is not in m");
    }
  }
  std::string missing;
  for (std::size_t i = 0; i < kCount; ++i) {
    if (!found[i]) missing += (missing.empty() ? "" : ", ") + std::string(kQuantities[i]);
  }
  if (!missing.empty()) throw Error(table.path.string(), "", "no column is named as " + missing);
  return columns;
}

Columns plainColumns() {
  Columns columns;
  for (std::size_t i = 0; i < kCount; ++i) columns.at[i] = i;
  return columns;
}

}  // namespace

std::vector<StampedPose> csvPoses(const CsvTable& table) {
  // No stamp is so many seconds, and nanoseconds since 1970 are since 1973.
  constexpr double kLeastNanoseconds = 1e17;
  const Columns columns = table.names.empty() ? plainColumns() : namedColumns(table);
  std::optional<double> seconds_in_unit = columns.seconds_in_unit;
  std::vector<StampedPose> poses;
  for (const TextLine& line : table.lines) {
    const std::vector<std::string_view> cells = csvCells(line.text);
    if (cells.size() != columns.cells) {
      throw Error(table.path.string(), linePlace(line.number),
                  std::to_string(cells.size()) + " values, where " + std::to_string(columns.cells) +
                      (table.names.empty() ? " or a line of names are needed" : " are named"));
    }
    std::array<double, kCount> values{};
    for (std::size_t i = 0; i < kCount; ++i) values[i] = csvNumber(table, line, cells, columns.at[i]);
    if (!seconds_in_unit) seconds_in_unit = values[0] >= kLeastNanoseconds ? 1e-9 : 1.0;
    values[0] *= *seconds_in_unit;
    poses.push_back(stampedPose(table.path, line.number, values));
  }
  return poses;
}

}  // namespace saw_ndt::internal
