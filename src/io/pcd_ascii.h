#pragma once

#include <filesystem>
#include <istream>
#include <vector>

#include "io/pcd_header.h"

namespace saw_ndt::internal {

/// Reads the points of an ASCII PCD file from behind its head, one point after the other in the form of a binary file.
/// Padding (fields named `_`) stays 0. Throws Error that names the line of what is no number of its field's type, of a
/// point with other numbers of values, or of one too many; blank lines are skipped.
std::vector<unsigned char> readPcdAscii(const std::filesystem::path& path, const PcdHeader& header,
                                        std::istream& stream);

}  // namespace saw_ndt::internal
