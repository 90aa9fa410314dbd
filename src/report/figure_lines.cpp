#include "report/figure_lines.h"

#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

namespace saw_ndt {
namespace {

void writeLine(std::ostringstream& text, const std::string& name, const nlohmann::ordered_json& value) {
  text << std::left << std::setw(29) << name << ' ' << value.dump() << '\n';
}

}  // namespace

std::string figureLines(const nlohmann::ordered_json& figures) {
  std::ostringstream text;
  for (const auto& [name, value] : figures.items()) {
    if (!value.is_object()) {
      writeLine(text, name, value);
      continue;
    }
    for (const auto& [part, part_value] : value.items()) writeLine(text, name + "." + part, part_value);
  }
  return text.str();
}

}  // namespace saw_ndt
