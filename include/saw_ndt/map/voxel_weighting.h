#pragma once

#include <array>
#include <cstdint>

#include "saw_ndt/common/export.h"
#include "saw_ndt/common/labels.h"

namespace saw_ndt {

/// Shape of the points of a voxel, the l_j of the paper: which of f_L, f_P, f_V is the largest.
enum class StructureClass : std::uint8_t { LINEAR = 1, PLANAR = 2, VOLUMETRIC = 3 };

/// Structural confidence s of a point by its label, in [0, 1]. A label of confidence 0 takes no part at all: neither in
/// the statistics of a voxel nor as a source point. The default trusts noise (points of components that are too small
/// for the segmentation to keep) less than the rest but does not drop it; paper() drops it.
struct SAW_NDT_EXPORT ConfidenceOptions {
  double noise = 0.85;
  double ground = 0.65;     ///< s_g of the paper, 0.5 there
  double non_ground = 1.0;  ///< s_o of the paper

  /// The confidences of the paper: rejected points take no part.
  static ConfidenceOptions paper() { return {0.0, 0.5, 1.0}; }
  /// Every point counts alike, whatever its label: classical NDT.
  static ConfidenceOptions uniform() { return {1.0, 1.0, 1.0}; }

  bool operator==(const ConfidenceOptions& other) const {
    return noise == other.noise && ground == other.ground && non_ground == other.non_ground;
  }
  double of(StructuralLabel label) const {
    return label == StructuralLabel::GROUND ? ground : label == StructuralLabel::NON_GROUND ? non_ground : noise;
  }
  /// Throws std::invalid_argument that names the field and its value.
  void check() const;
};

/// How large the voxels of a target are. Where `coarsest_m` is not greater than `finest_m`, all are of one size.
/// Otherwise every place has the smallest voxels, each level twice as large as the one before, that its points bear:
/// a voxel of any level but the last is left out unless it meets `min_scans`, one of any but the first unless it meets
/// `min_spread`. What no level takes has no distribution.
struct SAW_NDT_EXPORT VoxelSizes {
  double finest_m = 0.0;    ///< edge of the smallest (m), rounded to whole voxels of the map; 0: those of the map
  double coarsest_m = 0.0;  ///< edge that none exceeds (m), but for a map whose voxels do
  int min_scans = 2;        ///< scans that met the voxel, at least: one alone may be off, and draws its rings as lines
  double min_spread = 0.2;  ///< least standard deviation of the points along the second principal axis, in edges;
                            ///< points that cover a face have 0.29, a line has none

  bool operator==(const VoxelSizes& other) const {
    return finest_m == other.finest_m && coarsest_m == other.coarsest_m && min_scans == other.min_scans &&
           min_spread == other.min_spread;
  }
  /// Throws std::invalid_argument that names the field and its value.
  void check() const;
};

/// How the points of a voxel become its distribution and its weight w_target = mean confidence * alpha(class).
struct SAW_NDT_EXPORT VoxelWeighting {
  ConfidenceOptions confidence;
  double linear_alpha = 0.75;          ///< alpha of linear voxels
  double planar_alpha = 1.25;          ///< alpha of planar voxels
  double volumetric_alpha = 1.0;       ///< alpha of volumetric voxels
  int min_points_per_voxel = 6;        ///< voxels with fewer points have no distribution; at least 3
  double min_eigenvalue_ratio = 0.01;  ///< smaller eigenvalues are raised to this share of the largest, in (0, 1];
                                       ///< 0.01 is PCL's
  /// Whether flat voxels of ground are taken to reach on without end, so that they hold a pose along their normal
  /// alone. Where the points of ground lie within a voxel says where the rings fell, not where the ground is.
  bool unbounded_ground = false;
  VoxelSizes sizes;       ///< by default those of the map
  int coarse_factor = 3;  ///< edge of a coarse voxel, in the smallest ones: 2 or more; 1: no coarse level

  bool operator==(const VoxelWeighting& other) const {
    return confidence == other.confidence && linear_alpha == other.linear_alpha && planar_alpha == other.planar_alpha &&
           volumetric_alpha == other.volumetric_alpha && min_points_per_voxel == other.min_points_per_voxel &&
           min_eigenvalue_ratio == other.min_eigenvalue_ratio && unbounded_ground == other.unbounded_ground &&
           sizes == other.sizes && coarse_factor == other.coarse_factor;
  }
  double alpha(StructureClass structure_class) const {
    return structure_class == StructureClass::LINEAR   ? linear_alpha
           : structure_class == StructureClass::PLANAR ? planar_alpha
                                                       : volumetric_alpha;
  }
  /// Throws std::invalid_argument that names the field and its value.
  void check() const;
};

}  // namespace saw_ndt
