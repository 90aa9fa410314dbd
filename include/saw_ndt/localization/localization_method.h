#pragma once

#include <string>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/map/voxel_weighting.h"

namespace saw_ndt {

/// What tells the localization methods apart: which points of a scan take part, and how pairs weigh.
struct SAW_NDT_EXPORT LocalizationMethod {
  std::string name;
  bool segment = true;                  ///< label the scan; without it every raw point is a source point
  double ground_ratio = 0.5;            ///< rho, the share of ground points kept, in [0, 1]
  bool use_weights = true;              ///< W_ij of eq. (1) of the paper, or 1
  VoxelWeighting voxels;                ///< how the map is read; its confidences are the source points' as well
  double mismatch_penalty = 0.1;        ///< lambda_m
  double outlier_ratio = 0.55;          ///< of Magnusson's score function, in (0, 1)
  double coarse_settled_voxels = 0.02;  ///< see AlignmentOptions::coarse_settled_voxels
  bool ground_in_own_column = false;    ///< see AlignmentOptions::ground_in_own_column

  double covariance_scale = 4.0;  ///< see AlignmentOptions::covariance_scale

  /// Throws std::invalid_argument that names the field and its value.
  void check() const;

  /// `weighted` (ours), and the paper's `weighted-s50`, `weighted-s100`, `unweighted-s50` and `classical`.
  /// @throws std::invalid_argument that lists the names, for another one
  static LocalizationMethod named(const std::string& name);
  static const std::vector<std::string>& names();
};

}  // namespace saw_ndt
