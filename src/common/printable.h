#pragma once

#include <string>

#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

/// A text with its control characters, but line feeds, written as \x1b and the like: what stands in a file must neither
/// reach a terminal as a command nor, as a NUL, cut a message short.
SAW_NDT_EXPORT std::string printable(const std::string& text);

/// The same on one line: line feeds become blanks.
SAW_NDT_EXPORT std::string printableLine(const std::string& text);

}  // namespace saw_ndt::internal
