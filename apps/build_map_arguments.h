#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app_options.h"
#include "drives/drive_plan.h"
#include "motion_argument.h"
#include "recording_argument.h"
#include "saw_ndt/drives/drive_map.h"
#include "segmentation_options.h"

namespace saw_ndt {

/// The command line of the apps that build a map of drives, and what it makes of them.
class BuildMapArguments {
 public:
  /// Declares SEQUENCE... and MAP, and the options. `app` must live as long as this.
  explicit BuildMapArguments(AppOptions& app);

  const std::string& mapFile() const { return map_file_; }

  /// Opens a drive, by its number. The recording is valid until another one is opened.
  /// @throws Error, UsageError
  const Recording& open(int drive);

  /// Finds out which scans of every drive are to be mapped, and how, and that the map can be written. Says on stderr
  /// what was learned of sensor and mounting. @throws Error, UsageError
  std::vector<internal::DrivePlan> plan();

  /// The options that are the same for all drives. `scan_left_out` is set unless -strict is given, to add to `left_out`
  /// and to call `scan_done`.
  DriveMapOptions options(std::vector<std::string>& left_out, std::function<void()> scan_done) const;

  /// A line a drive: how motion was taken out of its scans, and why. Once there is a plan.
  const std::string& motionText() const { return motion_text_; }

 private:
  std::vector<std::string> posesFiles() const;
  internal::DrivePlan planOf(const Recording& recording, const std::vector<int>& selected,
                             const std::optional<SegmentationOptions>& of_map);
  void requireSegmentedAlike(const internal::DrivePlan& plan, const internal::DrivePlan& first,
                             const Recording& recording) const;
  void keepShard(std::vector<internal::DrivePlan>& plans) const;

  const AppOptions& app_;
  std::vector<std::string> sequences_;
  std::string map_file_, scans_ = ":", shard_ = "1/1", poses_files_;
  double resolution_m_;
  bool classical_ = false, strict_ = false;
  SegmentationArguments segmentation_;
  RecordingArgument recording_argument_;
  MotionArgument motion_;

  std::unique_ptr<Recording> recording_;
  int open_drive_ = -1;
  std::string motion_text_;
};

/// What a map holds, as the apps say it: "a.map: 5 voxels of 0.5 m from 9 points of 3 scans, 1 left out".
std::string mapText(const std::string& map_file, std::size_t voxel_count, const MapOrigin& origin,
                    std::size_t left_out_count);

}  // namespace saw_ndt
