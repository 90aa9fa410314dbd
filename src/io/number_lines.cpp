#include "io/number_lines.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>

#include "common/input_file.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

namespace {
constexpr std::string_view kBlanks = " \t\r\f\v";
}  // namespace

std::string linePlace(std::size_t number) { return "line " + std::to_string(number); }

std::vector<TextLine> readAllLines(const std::filesystem::path& path) {
  std::ifstream stream = openTextFile(path);
  std::vector<TextLine> lines;
  std::string text;
  for (std::size_t number = 1; std::getline(stream, text); ++number) {
    if (text.find_first_not_of(kBlanks) != std::string::npos) lines.push_back({number, text});
  }
  if (stream.bad()) throw Error(path.string(), "", "could not be read");
  return lines;
}

bool isComment(const TextLine& line) {
  const std::size_t first = line.text.find_first_not_of(kBlanks);
  return first != std::string::npos && line.text[first] == '#';
}

std::vector<TextLine> readTextLines(const std::filesystem::path& path) {
  std::vector<TextLine> lines = readAllLines(path);
  lines.erase(std::remove_if(lines.begin(), lines.end(), isComment), lines.end());
  return lines;
}

std::vector<double> parseNumbers(const std::filesystem::path& path, std::size_t line, std::string_view text) {
  std::vector<double> values;
  for (std::size_t first = text.find_first_not_of(kBlanks); first != std::string_view::npos;
       first = text.find_first_not_of(kBlanks)) {
    text.remove_prefix(first);
    const std::string_view word = text.substr(0, text.find_first_of(kBlanks));
    const std::string_view digits = word.front() == '+' ? word.substr(1) : word;
    double value = 0.0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size() || !std::isfinite(value)) {
      throw Error(path.string(), linePlace(line), "'" + std::string(word.substr(0, 40)) + "' is no finite number");
    }
    values.push_back(value);
    text.remove_prefix(word.size());
  }
  return values;
}

std::vector<NumberLine> parseNumberLines(const std::filesystem::path& path, const std::vector<TextLine>& lines) {
  std::vector<NumberLine> numbers;
  for (const TextLine& line : lines) {
    if (!isComment(line)) numbers.push_back({line.number, parseNumbers(path, line.number, line.text)});
  }
  return numbers;
}

std::vector<NumberLine> readNumberLines(const std::filesystem::path& path) {
  return parseNumberLines(path, readAllLines(path));
}

}  // namespace saw_ndt::internal
