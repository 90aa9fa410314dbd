#pragma once

#include <filesystem>

#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

/// Whether a file is a capture of network packets (pcap, of either byte order and with times in us or ns, or pcapng),
/// by its first bytes. False where it cannot be read.
SAW_NDT_EXPORT bool isCapture(const std::filesystem::path& path);

}  // namespace saw_ndt::internal
