#include "report/method_colour.h"

#include <array>
#include <utility>

#include "report/benchmark.h"

namespace saw_ndt {

std::string methodColour(const std::string& method) {
  static const std::array<std::pair<const char*, const char*>, 6> colours{{{"classical", "#E69F00"},
                                                                           {"unweighted-s50", "#56B4E9"},
                                                                           {"weighted-s100", "#009E73"},
                                                                           {"weighted-s50", "#0072B2"},
                                                                           {"weighted", "#D55E00"},
                                                                           {kPclNdtMethod, "#CC79A7"}}};
  for (const auto& [name, colour] : colours) {
    if (method == name) return colour;
  }
  return "#777777";
}

}  // namespace saw_ndt
