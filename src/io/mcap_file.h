#pragma once

#include <filesystem>
#include <memory>

#include "io/message_file.h"

namespace saw_ndt::internal {

/// Opens an .mcap file, also one that was cut short or has no summary. Throws Error.
std::unique_ptr<MessageFile> openMcap(const std::filesystem::path& path);

}  // namespace saw_ndt::internal
