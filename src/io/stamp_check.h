#pragma once

#include <string>
#include <vector>

#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

/// What is odd about the stamps (s) of scans or poses in their order, and what to try, a sentence each: those that seem
/// to be no seconds, to be rounded, that equal the one before, or that lie before it. Empty where nothing is.
SAW_NDT_EXPORT std::vector<std::string> oddStamps(const std::vector<double>& stamps_s);

}  // namespace saw_ndt::internal
