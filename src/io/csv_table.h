#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "io/number_lines.h"

namespace saw_ndt::internal {

/// A text file of values separated by commas.
struct CsvTable {
  std::filesystem::path path;
  std::vector<std::string> names;  ///< of the columns, without blanks and quotes around them; none where not stated
  std::vector<TextLine> lines;     ///< of values, without comments
};

/// Whether the first line that is no comment has a comma.
bool isCsv(const std::vector<TextLine>& lines);

/// The table of all lines of a file (readAllLines()). The names are those of the first line where none of its cells is
/// a number, else of the comment before it where that has as many cells. Throws Error where no line of values is there.
CsvTable csvTable(const std::filesystem::path& path, const std::vector<TextLine>& lines);

/// The cells of a line, without blanks and quotes around them.
std::vector<std::string_view> csvCells(std::string_view line);

/// The number of a cell (from 0). Throws Error that names the line and quotes what is no finite number.
double csvNumber(const CsvTable& table, const TextLine& line, const std::vector<std::string_view>& cells,
                 std::size_t column);

/// The numbers of all lines. Throws Error that names the line where something else is there, and where their count is
/// none of `counts`.
std::vector<NumberLine> csvNumberLines(const CsvTable& table, const std::vector<std::size_t>& counts);

}  // namespace saw_ndt::internal
