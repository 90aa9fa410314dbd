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

/// The same from several scans, at least one: what most of them show, of as many the first.
SAW_NDT_EXPORT LearnedSensor learnSensor(const std::vector<ScanView>& scans);

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
/// in a scan by itself, as over the roof of a vehicle, and only for GroundRule::GROWING, which uses it.
SAW_NDT_EXPORT SegmentationOptions withMounting(const SegmentationOptions& options, const LearnedMounting& mounting,
                                                const ScanView& scan);

/// Options with a greater slope of the ground where one of some scans shows ground as steep: by each of a few degrees
/// more it gains a lot of ground at first and then none. What grows on and on are other surfaces.
SAW_NDT_EXPORT SegmentationOptions withSlope(const SegmentationOptions& options, const std::vector<ScanView>& scans);

/// What in a scan tells that it is segmented by wrong options.
struct SegmentationDoubt {
  /// What may be wrong.
  enum class Cause {
    SENSOR,     ///< SegmentationOptions::sensor: points off the beams, or most of them noise
    MOUNTING,   ///< the angles of the mounting: hardly any ground, or ground that leans
    HEIGHT,     ///< GroundOptions::sensor_height_m: an unlikely height, as of points in the frame of the vehicle
    NO_RETURN,  ///< ranges and vehicle box: no point counts
  };

  Cause cause;
  std::string seen;  ///< a sentence without its full stop
};

/// Segments a scan and tells what is doubtful about it.
SAW_NDT_EXPORT std::vector<SegmentationDoubt> segmentationDoubts(const ScanView& scan,
                                                                 const SegmentationOptions& options);

}  // namespace saw_ndt
