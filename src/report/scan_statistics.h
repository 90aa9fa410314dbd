#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "saw_ndt/common/scan_view.h"
#include "saw_ndt/segmentation/scan_segmenter.h"

namespace saw_ndt {

/// Figures of a scan by their names, in a fixed order: the same names for the same sensor, with classes and without.
using ScanStatistics = std::vector<std::pair<std::string, double>>;

/// What a scan looks like to the methods of this project: points, quantiles of the range (m), points a ring (means over
/// eighths of the rings, top first), occupied voxels, shares of the labels that segmentation gives, thickness of flat
/// surfaces (m) and, with classes, the share of SemanticKITTI's ground among the points whose class is known.
/// @param semantic_classes  one a point, or none
ScanStatistics scanStatistics(const ScanView& scan, const std::vector<std::uint16_t>& semantic_classes,
                              ScanSegmenter& segmenter);

}  // namespace saw_ndt
