#pragma once

#include <optional>
#include <string>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/common/scan_view.h"
#include "saw_ndt/segmentation/segmentation_options.h"

namespace saw_ndt {

/// The beams that scans show.
struct LearnedSensor {
  /// One of SensorModel::named() where the beams are its, else one of its own; without rows where there are no beams.
  SensorModel model;
  /// What tells the beams apart: "rings", "rows", "file order" or "elevations"; "no beams".
  std::string evidence;
};

/// Learns beams, their order and the width of the range image from a scan in the frame of its sensor: from its rows or
/// rings, from the order of its points, or else from elevations at which points crowd. A LiDAR without beams, several
/// of them in one cloud, and a cloud in another frame have none.
SAW_NDT_EXPORT LearnedSensor learnSensor(const ScanView& scan);

/// How a sensor stands above the ground.
struct LearnedMounting {
  double pitch_deg = 0.0;  ///< as SegmentationOptions::mounting_pitch_deg
  double roll_deg = 0.0;   ///< as SegmentationOptions::mounting_roll_deg
  double height_m = 0.0;   ///< of the sensor above the ground
};

/// Finds the ground around a sensor (RANSAC within 25 m): the plane of most points that has next to none behind it, and
/// leans from the sensor's axis by no more than 50 degrees, upside down too. What has ground behind it, such as the
/// roof of the vehicle, is none. Nothing where there is no such plane. The same scan gives the same answer.
SAW_NDT_EXPORT std::optional<LearnedMounting> learnMounting(const ScanView& scan);

/// The median of what several scans show, each of pitch, roll and height.
SAW_NDT_EXPORT std::optional<LearnedMounting> learnMounting(const std::vector<ScanView>& scans);

/// Options with a mounting that has been learned, where it matters: the angles where the sensor leans by more than 5
/// degrees, since up to that ground may as well be what leans; the height where it is not that which a segmenter finds
/// in a scan by itself, as over the roof of a vehicle.
SAW_NDT_EXPORT SegmentationOptions withMounting(const SegmentationOptions& options, const LearnedMounting& mounting,
                                                const ScanView& scan);

/// What in a scan tells that it is segmented by wrong options: points off the beams, hardly any ground, most of it
/// noise, an unlikely height of the sensor, another frame. A sentence for each, that says what was seen.
SAW_NDT_EXPORT std::vector<std::string> segmentationDoubts(const ScanView& scan, const SegmentationOptions& options);

}  // namespace saw_ndt
