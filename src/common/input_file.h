#pragma once

#include <filesystem>
#include <fstream>

#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

/// Throws Error with the system's reason where there is no such file or it is a folder, and where it is no regular
/// file: to open a pipe may wait forever, and a device may never end.
SAW_NDT_EXPORT void requireRegularFile(const std::filesystem::path& path);

/// Opens a regular file for binary reading. Throws Error with the system's reason where that fails.
SAW_NDT_EXPORT std::ifstream openInputFile(const std::filesystem::path& path);

/// The same of a text, behind the byte-order mark that it may begin with.
SAW_NDT_EXPORT std::ifstream openTextFile(const std::filesystem::path& path);

}  // namespace saw_ndt::internal
