#include "saw_ndt/io/polygon_file.h"

#include <algorithm>
#include <cctype>
#include <string>

#include "io/csv_table.h"
#include "io/number_lines.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt {

using namespace internal;

namespace {

constexpr std::size_t kColumns = 2;

// The column of a coordinate, `x` or `y`.
std::size_t columnOf(const CsvTable& table, const std::string& coordinate) {
  const auto found = std::find_if(table.names.begin(), table.names.end(), [&](std::string name) {
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
    return name == coordinate || name == coordinate + "_m";
  });
  if (found == table.names.end()) throw Error(table.path.string(), "", "names no column " + coordinate);
  return static_cast<std::size_t>(found - table.names.begin());
}

std::vector<Eigen::Vector2d> csvVertices(const CsvTable& table) {
  const bool has_names = !table.names.empty();
  const std::size_t columns = has_names ? table.names.size() : kColumns;
  const std::size_t x = has_names ? columnOf(table, "x") : 0, y = has_names ? columnOf(table, "y") : 1;
  std::vector<Eigen::Vector2d> vertices;
  for (const TextLine& line : table.lines) {
    const std::vector<std::string_view> cells = csvCells(line.text);
    if (cells.size() != columns) {
      throw Error(table.path.string(), linePlace(line.number),
                  std::to_string(cells.size()) + " values, where " + std::to_string(columns) + " are needed");
    }
    vertices.emplace_back(csvNumber(table, line, cells, x), csvNumber(table, line, cells, y));
  }
  return vertices;
}

std::vector<Eigen::Vector2d> plainVertices(const std::filesystem::path& path, const std::vector<TextLine>& lines) {
  std::vector<Eigen::Vector2d> vertices;
  for (const NumberLine& line : parseNumberLines(path, lines)) {
    if (line.values.size() != kColumns) {
      throw Error(path.string(), linePlace(line.number),
                  std::to_string(line.values.size()) + " numbers, where x and y are needed");
    }
    vertices.emplace_back(line.values[0], line.values[1]);
  }
  return vertices;
}

}  // namespace

std::vector<Eigen::Vector2d> readPolygon(const std::filesystem::path& path) {
  const std::vector<TextLine> lines = readAllLines(path);
  std::vector<Eigen::Vector2d> vertices =
      isCsv(lines) ? csvVertices(csvTable(path, lines)) : plainVertices(path, lines);
  if (vertices.size() > 1 && vertices.front() == vertices.back()) vertices.pop_back();
  if (vertices.size() < 3) {
    throw Error(path.string(), "", "a polygon has 3 vertices or more, this one has " + std::to_string(vertices.size()));
  }
  return vertices;
}

}  // namespace saw_ndt
