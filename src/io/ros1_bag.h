#pragma once

#include <filesystem>
#include <memory>

#include "io/message_file.h"

namespace saw_ndt::internal {

/// Opens a bag of ROS 1, version 2.0. Throws Error where it is not indexed or cut short, which `rosbag reindex` mends.
std::unique_ptr<MessageFile> openRos1Bag(const std::filesystem::path& path);

}  // namespace saw_ndt::internal
