#pragma once

#include <filesystem>
#include <memory>

#include "io/message_file.h"

namespace saw_ndt::internal {

/// Opens a .db3 file of a ROS 2 bag. Nothing is written beside it. Throws Error.
std::unique_ptr<MessageFile> openRosbag2Database(const std::filesystem::path& path);

}  // namespace saw_ndt::internal
