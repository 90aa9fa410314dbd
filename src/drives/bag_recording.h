#pragma once

#include <filesystem>
#include <memory>

#include "io/message_file.h"
#include "saw_ndt/common/export.h"
#include "saw_ndt/drives/recording.h"

namespace saw_ndt::internal {

/// Opens a recording of ROS; see isBag(). Its scans are the messages of one topic of sensor_msgs/PointCloud2, by the
/// times when they were recorded; their stamps are those of their headers, or these times where they are 0 or the
/// message is damaged. Reference poses are told between two stamps that are no more than 1 s apart: those of a topic of
/// poses, whose body is the LiDAR unless the message names another one that transforms lead from to the LiDAR; or the
/// chain of transforms to the LiDAR. RecordingOptions::poses_file is not read here, and there are no poses then.
/// Throws Error, also where the topic or the poses are not the only ones and not chosen.
SAW_NDT_EXPORT std::unique_ptr<Recording> openBag(const std::filesystem::path& path, const RecordingOptions& options);

}  // namespace saw_ndt::internal
