#pragma once

#include <pcl/point_types.h>
#include <pcl/registration/registration.h>

#include "saw_ndt/common/export.h"
#include "saw_ndt/map/ndt_target.h"
#include "saw_ndt/registration/ndt_aligner.h"

namespace saw_ndt {

/// Registers a cloud to a weighted voxel map: the segmentation-aware weighted NDT of the paper, and a drop-in for
/// pcl::NormalDistributionsTransform.
///
/// Weights act when both clouds carry StructuralLabel values in a `label` field (or the target is a labelled map) and
/// setUseWeights(true), the default. Otherwise every pair weighs 1 and the score is Magnusson's, as in PCL.
///
/// Where it differs from pcl::NormalDistributionsTransform 1.13 on purpose:
///  - the default optimizer is DAMPED_NEWTON with a coarse level first; setOptimizer(NEWTON_MORE_THUENTE) gives PCL's;
///  - the default neighbours are DIRECT7; setNeighborhoodSearchMethod(RADIUS) gives PCL's;
///  - hasConverged() is false at the iteration limit, without a target or a finite source point, and where no or too
///  few
///    points of the source fit the target (AlignmentOptions::min_overlap); getAlignmentResult() tells why, and has the
///    covariance, the overlap, and the directions that nothing holds;
///  - the result does not depend on where the origins are: a source far from its own is turned about its middle;
///  - DAMPED_NEWTON reads the translation epsilon in metres and the rotation epsilon as a cosine, and stops at the
///    smaller of it and 1 mm, or 0.05 mrad: PCL's default of 0.1 would stop it centimetres short.
///    NEWTON_MORE_THUENTE reads them as PCL does: squared metres and a cosine, an epsilon <= 0 switched off;
///  - setIndices() is honoured; points that are not finite, or 1e9 m away, are passed over, in source and target, and
///    in a target those at (0, 0, 0), which are no returns;
///  - setResolution() and setMinPointPerVoxel() take effect at once, in whatever order calls come;
///  - an empty target or source replaces the one before it; aligning then fails instead of using the old one;
///  - the target may lie anywhere: no bound on the extent of its voxel grid;
///  - the k-d tree of the target is built only when getFitnessScore() asks for it, which without a source is the
///    greatest number, as where no point has a neighbour;
///  - an index of setIndices() beyond the source is a std::out_of_range of align().
/// One object is not to be shared by threads; copies may be used at the same time, and targets and clouds be shared.
template <typename PointSource, typename PointTarget, typename Scalar = float>
class SAW_NDT_EXPORT WeightedNormalDistributionsTransform : public pcl::Registration<PointSource, PointTarget, Scalar> {
  using Base = pcl::Registration<PointSource, PointTarget, Scalar>;

 public:
  using Ptr = pcl::shared_ptr<WeightedNormalDistributionsTransform>;
  using ConstPtr = pcl::shared_ptr<const WeightedNormalDistributionsTransform>;
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  using Matrix4 = typename Base::Matrix4;
  using Affine3 = Eigen::Transform<Scalar, 3, Eigen::Affine>;
  using PointCloudSource = typename Base::PointCloudSource;
  using PointCloudSourceConstPtr = typename Base::PointCloudSourceConstPtr;
  using PointCloudTarget = typename Base::PointCloudTarget;
  using PointCloudTargetConstPtr = typename Base::PointCloudTargetConstPtr;

  WeightedNormalDistributionsTransform();
  /// A copy shares target and source, which do not change, but no k-d tree.
  WeightedNormalDistributionsTransform(const WeightedNormalDistributionsTransform& other);
  WeightedNormalDistributionsTransform& operator=(const WeightedNormalDistributionsTransform& other);

  /// Builds the voxels of a target cloud at once; an empty cloud leaves no target.
  /// @throws std::invalid_argument where a `label` field holds what is no StructuralLabel, unless weights are off
  void setInputTarget(const PointCloudTargetConstPtr& cloud) override;
  void setInputSource(const PointCloudSourceConstPtr& cloud) override;

  /// As pcl::Registration.
  /// @throws std::out_of_range where setIndices() names a point that the source does not have; through a pointer to
  /// pcl::Registration, PCL reads such points before this class is asked
  void align(PointCloudSource& output) { align(output, Matrix4::Identity()); }
  void align(PointCloudSource& output, const Matrix4& guess);

  /// Registers to a map instead of a cloud; getFitnessScore() then measures to the means of its voxels.
  /// Arithmetic::DOUBLE needs one made with CellPrecision::SINGLE_AND_DOUBLE.
  void setTargetMap(const NdtTarget& map);
  /// The target's voxels; empty before there is a target.
  const NdtTarget& getTargetMap() const { return map_; }

  /// Edge of a voxel (m) of a target cloud. @throws std::invalid_argument unless positive, std::logic_error where the
  /// target is a map of another resolution, which cannot be cut anew
  void setResolution(float resolution);
  float getResolution() const { return resolution_; }
  /// Fewest points of a voxel that is used, 3 or more; 6 by default.
  void setMinPointPerVoxel(unsigned int min_points_per_voxel);
  /// Confidences, alphas and limits that target clouds become voxels by. A map brings its own.
  void setVoxelWeighting(const VoxelWeighting& weighting);
  const VoxelWeighting& getVoxelWeighting() const { return weighting_; }

  /// Longest step of the line search of NEWTON_MORE_THUENTE, metres and radians in one norm; 0.1 by default.
  void setStepSize(double step_size) { options_.line_search_max_step = step_size; }
  double getStepSize() const { return options_.line_search_max_step; }
  /// Expected share of outliers, in (0, 1); 0.55 by default.
  void setOutlierRatio(double outlier_ratio) { options_.outlier_ratio = outlier_ratio; }
  double getOutlierRatio() const { return options_.outlier_ratio; }
  /// PCL's spelling before 1.14 of setOutlierRatio() and getOutlierRatio().
  void setOulierRatio(double outlier_ratio) { setOutlierRatio(outlier_ratio); }
  double getOulierRatio() const { return getOutlierRatio(); }

  void setNeighborhoodSearchMethod(NeighborhoodSearchMethod method) { options_.neighborhood_search = method; }
  NeighborhoodSearchMethod getNeighborhoodSearchMethod() const { return options_.neighborhood_search; }
  void setOptimizer(Optimizer optimizer) { options_.optimizer = optimizer; }
  Optimizer getOptimizer() const { return options_.optimizer; }
  /// Where weights are off, labels of a target cloud that are no StructuralLabel, such as classes, do not matter.
  /// @throws std::invalid_argument where they are switched on with such a target
  void setUseWeights(bool use_weights);
  bool getUseWeights() const { return options_.use_weights; }
  /// 0, the default: all cores. The result does not depend on it.
  void setNumberOfThreads(unsigned int threads);

  /// Everything else about the alignment. Iterations and epsilons are pcl::Registration's own
  /// (setMaximumIterations(), setTransformationEpsilon(), setTransformationRotationEpsilon()) and are not read here.
  void setAlignmentOptions(const AlignmentOptions& options);
  const AlignmentOptions& getAlignmentOptions() const { return options_; }

  /// score / number of source points, of the last alignment.
  double getTransformationLikelihood() const { return result_.likelihood; }
  /// PCL's name before 1.12 of getTransformationLikelihood().
  double getTransformationProbability() const { return result_.likelihood; }
  int getFinalNumIteration() const { return this->nr_iterations_; }
  /// Pose, status, evaluations, score, overlap, covariance and free directions of the last alignment.
  const AlignmentResult& getAlignmentResult() const { return result_; }

  /// The transform of [x y z roll pitch yaw] (m, rad), R = Rx Ry Rz.
  static void convertTransform(const Eigen::Matrix<double, 6, 1>& x, Affine3& trans);
  static void convertTransform(const Eigen::Matrix<double, 6, 1>& x, Matrix4& trans);

 protected:
  void computeTransformation(PointCloudSource& output, const Matrix4& guess) override;

 private:
  void copyFrom(const WeightedNormalDistributionsTransform& other);
  void buildTarget(const PointCloudTarget& cloud);
  void rebuildTarget();
  void takeOptions(const AlignmentOptions& options);
  SourcePoints selectedSource() const;
  AlignmentOptions effectiveOptions() const;

  AlignmentOptions options_;
  VoxelWeighting weighting_;
  float resolution_ = 1.0f;
  NdtTarget map_;
  bool target_is_map_ = false;
  NdtAligner aligner_;
  AlignmentResult result_;

 public:
  PCL_MAKE_ALIGNED_OPERATOR_NEW
};

}  // namespace saw_ndt

#include "saw_ndt/pcl/impl/weighted_normal_distributions_transform.hpp"

namespace saw_ndt {

extern template class WeightedNormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ, float>;
extern template class WeightedNormalDistributionsTransform<pcl::PointXYZI, pcl::PointXYZI, float>;
extern template class WeightedNormalDistributionsTransform<pcl::PointXYZL, pcl::PointXYZL, float>;
extern template class WeightedNormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ, double>;
extern template class WeightedNormalDistributionsTransform<pcl::PointXYZI, pcl::PointXYZI, double>;
extern template class WeightedNormalDistributionsTransform<pcl::PointXYZL, pcl::PointXYZL, double>;

}  // namespace saw_ndt
