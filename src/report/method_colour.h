#pragma once

#include <string>

namespace saw_ndt {

/// The colour of a method in every picture, #rrggbb: one that the colour-blind can tell from the others (Okabe and Ito)
/// for each of benchmarkMethodNames(), grey for another name.
std::string methodColour(const std::string& method);

}  // namespace saw_ndt
