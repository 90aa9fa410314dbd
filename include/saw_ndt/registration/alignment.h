#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <string>

#include "saw_ndt/common/export.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt {

/// The voxels that a source point is paired with.
enum class NeighborhoodSearchMethod {
  RADIUS,    ///< every voxel whose mean lies within one resolution of the point, as PCL
  DIRECT26,  ///< the point's own voxel and the 26 around it
  DIRECT7,   ///< the point's own voxel and the 6 that share a face with it
  DIRECT3,   ///< the point's own voxel and those above and below it
  DIRECT1,   ///< the point's own voxel
};

/// The function of the squared Mahalanobis distance m that a source-voxel pair scores: amplitude * exp(-d2 / 2 * m).
enum class ScoreFunction {
  MAGNUSSON,  ///< eq. 6.8 to 6.10 of Magnusson (2009): a normal distribution mixed with uniform outliers, as PCL
  PAPER,      ///< eq. (2) of the weighted NDT paper: amplitude 1, d2 = 1
};

/// How well a pose explains a source, in figures that weights do not change. Each is of Magnusson's score function for
/// voxels of 1 m, whatever the map's are: they depend little on how large those are, and one threshold serves all maps.
struct Likelihoods {
  /// Sum over all pairs / number of source points: PCL's, with every weight 1, where voxels are of 1 m.
  double unweighted = 0.0;
  /// The same over the points not labelled ground. The ground keeps the others high where a pose is lost along a road.
  double non_ground = 0.0;
  double nearest_voxel = 0.0;  ///< mean over the points that meet a voxel of the score of their best voxel
};

/// How the pose of greatest score is sought.
enum class Optimizer {
  DAMPED_NEWTON,        ///< Newton steps on SE(3) that stay ascending where the score is not concave
  NEWTON_MORE_THUENTE,  ///< PCL's: Newton steps in Euler angles with the line search of More and Thuente (1994)
};

/// How score and derivatives are computed.
enum class Arithmetic {
  SINGLE,  ///< single precision and the processor's vector instructions; within about 1e-6 of DOUBLE
  DOUBLE,  ///< plain double precision, tens of times slower: to compare with, and for voxels of less than a millimetre
};

struct SAW_NDT_EXPORT AlignmentOptions {
  NeighborhoodSearchMethod neighborhood_search = NeighborhoodSearchMethod::DIRECT7;
  /// Points labelled ground are paired by DIRECT3: voxels beside a point say nothing new of level ground.
  bool ground_in_own_column = false;
  ScoreFunction score_function = ScoreFunction::MAGNUSSON;
  double outlier_ratio = 0.55;    ///< expected share of outliers, in (0, 1)
  bool use_weights = true;        ///< false, or a source or map without labels: classical NDT, W = 1
  double mismatch_penalty = 0.1;  ///< lambda_m of the paper, in [0, 1]

  Arithmetic arithmetic = Arithmetic::SINGLE;
  Optimizer optimizer = Optimizer::DAMPED_NEWTON;
  int max_iterations = 35;              ///< steps on the levels that match, 1 or more
  double translation_epsilon_m = 1e-3;  ///< converged when a step is shorter than this (m) ...
  double rotation_epsilon_rad = 5e-5;   ///< ... and turns less than this (rad)
  double max_step_m = 0.5;              ///< longest step of DAMPED_NEWTON (m), at 1 m voxels; grows with the smallest
  /// Least share of the Gauss-Newton curvature that a Newton step of DAMPED_NEWTON reckons with, in (0, 1]; 1 is
  /// iteratively reweighted least squares, towards 0 is Newton's method, which leaves the basin where it is not
  /// concave.
  double min_curvature_share = 0.5;

  bool use_coarse_level = true;         ///< DAMPED_NEWTON: start on the coarse level where the map has one
  int coarse_max_iterations = 30;       ///< steps on the coarse level at most, 1 or more
  int coarse_stride = 4;                ///< every how many-th source point the coarse level uses, 1 or more
  double coarse_settled_voxels = 0.02;  ///< the coarse level is left when a step is shorter, in the smallest voxels

  double line_search_max_step = 0.1;   ///< NEWTON_MORE_THUENTE: longest step, metres and radians in one norm
  double line_search_min_step = 1e-6;  ///< NEWTON_MORE_THUENTE: shortest step; not above the epsilons

  bool evaluate_likelihoods = false;  ///< fill AlignmentResult::likelihoods, which costs a fraction of an evaluation
  double min_overlap = 0.3;           ///< with less of AlignmentResult::overlap an alignment is UNDETERMINED
  /// Factor of AlignmentResult::covariance. 4 fits voxels of 1 m and pairs that all weigh 1; LocalizationMethod has
  /// that of each method.
  double covariance_scale = 4.0;

  int threads = 0;  ///< 0: all cores

  /// Throws std::invalid_argument that names the field and its value.
  void check() const;
};

enum class AlignmentStatus {
  CONVERGED,
  ITERATION_LIMIT,  ///< the last step was still longer than ten times the epsilons
  NO_OVERLAP,       ///< no source point met a voxel
  NO_SOURCE,        ///< there is no finite source point
  NO_TARGET,        ///< the map has no voxel with a distribution
  UNDETERMINED,     ///< the pose rests on too few points, or too few of them fit the map
};

/// The status in words: "converged", "iteration limit", ...
SAW_NDT_EXPORT const char* toString(AlignmentStatus status);

/// In PoseDirections a rotation counts as the way of a point this far from its centre (m).
constexpr double kRotationArm_m = 10.0;

/// Directions of a pose, one a column: translation (m) and rotation (rad) times kRotationArm_m, in the axes of the map.
/// Orthonormal.
using PoseDirections = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 6>;

/// What AlignmentResult::covariance adds along a free direction: a standard deviation of kFreeSigma_m (of a rotation,
/// of the way of a point kRotationArm_m from its centre).
constexpr double kFreeSigma_m = 20.0;
SAW_NDT_EXPORT Matrix6d freeCovariance(const PoseDirections& free_directions);

struct AlignmentResult {
  Eigen::Isometry3d T_map_source = Eigen::Isometry3d::Identity();
  AlignmentStatus status = AlignmentStatus::NO_SOURCE;
  int iterations = 0;   ///< steps taken on the levels that match
  int evaluations = 0;  ///< evaluations of score, gradient and Hessian on any level
  double score = 0.0;   ///< at the pose of the last evaluation, less than the epsilons from T_map_source if converged
  double likelihood = 0.0;  ///< score / number of source points, as PCL; it changes with the weights
  /// Of the final pose, where AlignmentOptions::evaluate_likelihoods asks for them; with PCL's outlier ratio.
  Likelihoods likelihoods;

  // What follows is by (v, w): points turn by exp(w) about the rotation centre and move by v (m), in the map's axes.

  /// The rotation centre in the frame of the source (m): its origin or, where the points lie more than 100 m away from
  /// it, their middle. So the result does not depend on where the origins of source and map are.
  Eigen::Vector3d rotation_centre = Eigen::Vector3d::Zero();
  /// Curvature of the score, what the step was solved with; positive semidefinite.
  Matrix6d information = Matrix6d::Zero();
  /// Of the pose. The inverse of the curvature, without what points tell of directions nearly parallel to the surface
  /// that they lie on (that is the noise of its normal), and scaled so that it holds on simulated drives with exact
  /// poses; see docs/trust.md. Errors are those of the map mainly: those of successive scans are alike, and more points
  /// of a scan make them no smaller. With freeCovariance() added.
  Matrix6d covariance = Matrix6d::Zero();
  /// What the surroundings do not hold, such as the way along a tunnel. The pose keeps there what the guess said, or
  /// comes to a chance optimum near it.
  PoseDirections free_directions = PoseDirections(6, 0);
  /// Share of a sample of the points not labelled ground that lie on a surface of the map, within three standard
  /// deviations. Where no labels are known, points on level surfaces of the map count as ground; where there
  /// is next to nothing but ground, of all. 0 to 1; not a number
  /// where it was not told.
  double overlap = std::numeric_limits<double>::quiet_NaN();

  bool converged() const { return status == AlignmentStatus::CONVERGED; }
};

/// The axes of the base along which a pose is free, in words such as "x yaw" (x y z roll pitch yaw); empty for none.
SAW_NDT_EXPORT std::string freeAxes(const PoseDirections& free_directions, const Eigen::Matrix3d& R_map_base);

/// Standard deviations along and about the axes of the base: x y z (m), roll pitch yaw (rad).
SAW_NDT_EXPORT Vector6d standardDeviations(const Matrix6d& covariance, const Eigen::Matrix3d& R_map_base);

}  // namespace saw_ndt
