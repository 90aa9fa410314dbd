#pragma once

#include <string>

#include "report/gnuplot.h"

namespace saw_ndt {

/// Finds out before the long work that the picture of `-picture FILE` can be drawn; nothing where FILE is empty.
/// @throws UsageError where gnuplot is missing or the file does not end in .png
/// @throws Error where the file cannot be written
void requireDrawable(const std::string& file);

}  // namespace saw_ndt
