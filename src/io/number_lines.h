#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace saw_ndt::internal {

/// A line of a text file and its number, from 1.
struct TextLine {
  std::size_t number;
  std::string text;
};

/// The numbers of one line of a text file.
struct NumberLine {
  std::size_t number;
  std::vector<double> values;
};

/// "line N", the place that an Error names.
std::string linePlace(std::size_t number);

/// The lines of a file that are not blank, without their ends and a byte-order mark.
std::vector<TextLine> readAllLines(const std::filesystem::path& path);

/// Whether '#' is the first character of a line that is no blank.
bool isComment(const TextLine& line);

/// readAllLines() without comments.
std::vector<TextLine> readTextLines(const std::filesystem::path& path);

/// Numbers separated by blanks, whatever the locale. Throws Error that quotes what is no finite number.
std::vector<double> parseNumbers(const std::filesystem::path& path, std::size_t line, std::string_view text);

/// The numbers of those lines that are no comments; see parseNumbers().
std::vector<NumberLine> parseNumberLines(const std::filesystem::path& path, const std::vector<TextLine>& lines);

/// readTextLines() and parseNumbers() in one.
std::vector<NumberLine> readNumberLines(const std::filesystem::path& path);

}  // namespace saw_ndt::internal
