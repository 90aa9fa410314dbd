#pragma once

#include <filesystem>
#include <memory>

#include "io/message_file.h"

namespace saw_ndt::internal {

/// Whether a folder is that of a ROS 2 bag: it has files of one, or metadata.yaml.
bool isMessageFolder(const std::filesystem::path& folder);

/// Opens all .db3 and .mcap files of a folder as one, in natural order. One that cannot be read is passed over with a
/// warning. Throws Error where there is none, none can be read, or one is compressed as a whole.
std::unique_ptr<MessageFile> openMessageFolder(const std::filesystem::path& folder);

}  // namespace saw_ndt::internal
