#pragma once

#include <filesystem>
#include <fstream>

#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

/// Opens a file for binary reading. Throws Error with the system's reason where that fails, or where it is a folder.
SAW_NDT_EXPORT std::ifstream openInputFile(const std::filesystem::path& path);

/// The same of a text, behind the byte-order mark that it may begin with.
SAW_NDT_EXPORT std::ifstream openTextFile(const std::filesystem::path& path);

}  // namespace saw_ndt::internal
