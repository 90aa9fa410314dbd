#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "saw_ndt/common/labels.h"

namespace saw_ndt {

/// Whether a SemanticKITTI class is ground: 40 road, 44 parking, 48 sidewalk, 49 other ground, 60 lane marking or
/// 72 terrain.
bool isSemanticKittiGround(std::uint16_t semantic_class);

/// How well the label Ground agrees with SemanticKITTI. Scores of several scans add up with +=.
struct GroundScore {
  std::size_t points = 0;        ///< of the scans, all of them
  std::size_t noise_points = 0;  ///< of all points, those labelled Noise
  // Of the points whose class is known: neither 0 (unlabelled) nor 1 (outlier).
  std::size_t true_positives = 0;   ///< ground found as such
  std::size_t false_positives = 0;  ///< found as ground and something else
  std::size_t false_negatives = 0;  ///< ground not found
  std::size_t true_negatives = 0;   ///< something else, and not found as ground

  // Ratios in [0, 1]; 0 where there is nothing to divide by.
  double precision() const;   ///< share of ground among what was found as ground
  double recall() const;      ///< share of the ground that was found
  double f1() const;          ///< harmonic mean of precision and recall
  double iou() const;         ///< intersection over union
  double noiseShare() const;  ///< share of Noise among all points

  GroundScore& operator+=(const GroundScore& other);
};

/// Scores the labels of one scan. @throws std::invalid_argument unless there are as many classes as labels
GroundScore scoreGround(const std::vector<StructuralLabel>& labels, const std::vector<std::uint16_t>& semantic_classes);

/// One JSON object, indented, with a line end: precision, recall, f1, iou, noise_share, then the counts.
std::string toJsonText(const GroundScore& score);

}  // namespace saw_ndt
