#include "io/csv_table.h"

#include <algorithm>
#include <utility>

#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kAround = " \t\r\f\v\"";
  const std::size_t first = text.find_first_not_of(kAround);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kAround) - first + 1);
}

bool isNumber(std::string_view cell) {
  try {
    return parseNumbers("", 0, cell).size() == 1;
  } catch (const Error&) {
    return false;
  }
}

std::vector<std::string> namesIn(std::string_view line) {
  line = trimmed(line);
  line.remove_prefix(std::min(line.find_first_not_of("#%"), line.size()));
  std::vector<std::string> names;
  for (const std::string_view cell : csvCells(line)) names.emplace_back(cell);
  return names;
}

}  // namespace

bool isCsv(const std::vector<TextLine>& lines) {
  const auto first = std::find_if_not(lines.begin(), lines.end(), isComment);
  return first != lines.end() && first->text.find(',') != std::string::npos;
}

CsvTable csvTable(const std::filesystem::path& path, const std::vector<TextLine>& lines) {
  CsvTable table{path, {}, {}};
  auto first = std::find_if_not(lines.begin(), lines.end(), isComment);
  if (first != lines.end()) {
    const std::vector<std::string_view> cells = csvCells(first->text);
    if (std::none_of(cells.begin(), cells.end(), isNumber)) {
      table.names = namesIn(first->text);
      ++first;
    } else if (first != lines.begin()) {
      table.names = namesIn(std::prev(first)->text);
      if (table.names.size() != cells.size()) table.names.clear();
    }
  }
  std::remove_copy_if(first, lines.end(), std::back_inserter(table.lines), isComment);
  if (table.lines.empty()) throw Error(path.string(), "", "holds no line of numbers");
  return table;
}

std::vector<std::string_view> csvCells(std::string_view line) {
  std::vector<std::string_view> cells;
  for (std::size_t comma = line.find(','); comma != std::string_view::npos; comma = line.find(',')) {
    cells.push_back(trimmed(line.substr(0, comma)));
    line.remove_prefix(comma + 1);
  }
  cells.push_back(trimmed(line));
  return cells;
}

double csvNumber(const CsvTable& table, const TextLine& line, const std::vector<std::string_view>& cells,
                 std::size_t column) {
  const std::vector<double> numbers = parseNumbers(table.path, line.number, cells[column]);
  if (numbers.size() == 1) return numbers.front();
  throw Error(
      table.path.string(), linePlace(line.number),
      std::to_string(numbers.size()) + " numbers in column " + std::to_string(column + 1) + ", where one is needed");
}

std::vector<NumberLine> csvNumberLines(const CsvTable& table, const std::vector<std::size_t>& counts) {
  std::vector<NumberLine> lines;
  for (const TextLine& line : table.lines) {
    const std::vector<std::string_view> cells = csvCells(line.text);
    if (std::find(counts.begin(), counts.end(), cells.size()) == counts.end()) {
      std::string wanted = std::to_string(counts.front());
      for (std::size_t i = 1; i < counts.size(); ++i) wanted += " or " + std::to_string(counts[i]);
      throw Error(table.path.string(), linePlace(line.number),
                  std::to_string(cells.size()) + " numbers, where " + wanted + " are needed");
    }
    NumberLine& numbers = lines.emplace_back(NumberLine{line.number, {}});
    for (std::size_t i = 0; i < cells.size(); ++i) numbers.values.push_back(csvNumber(table, line, cells, i));
  }
  return lines;
}

}  // namespace saw_ndt::internal
