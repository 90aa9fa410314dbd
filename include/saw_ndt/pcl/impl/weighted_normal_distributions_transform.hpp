#pragma once

#include <pcl/common/transforms.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/map/weighted_map_builder.h"
#include "saw_ndt/pcl/cloud_view.h"
#include "saw_ndt/pcl/impl/checked_indices.h"
#include "saw_ndt/pcl/impl/lazy_kdtree.h"

namespace saw_ndt {

template <typename PointSource, typename PointTarget, typename Scalar>
WeightedNormalDistributionsTransform<PointSource, PointTarget, Scalar>::WeightedNormalDistributionsTransform() {
  this->reg_name_ = "WeightedNormalDistributionsTransform";
  // PCL's getFitnessScore() and setIndices() look into the source, whether there is one or not.
  this->input_ = pcl::make_shared<PointCloudSource>();
  this->tree_.reset(new LazyKdTree<PointTarget>());
  this->max_iterations_ = 35;
  this->transformation_epsilon_ = 0.1;
}

template <typename PointSource, typename PointTarget, typename Scalar>
WeightedNormalDistributionsTransform<PointSource, PointTarget, Scalar>::WeightedNormalDistributionsTransform(
    const WeightedNormalDistributionsTransform& other)
    : Base(other) {
  copyFrom(other);
}

template <typename PointSource, typename PointTarget, typename Scalar>
WeightedNormalDistributionsTransform<PointSource, PointTarget, Scalar>&
WeightedNormalDistributionsTransform<PointSource, PointTarget, Scalar>::operator=(
    const WeightedNormalDistributionsTransform& other) {
  Base::operator=(other);
  copyFrom(other);
  return *this;
}

template <typename PointSource, typename PointTarget, typename Scalar>
void WeightedNormalDistributionsTransform<PointSource, PointTarget, Scalar>::copyFrom(
    const WeightedNormalDistributionsTransform& other) {
  options_ = other.options_;
  weighting_ = other.weighting_;
  resolution_ = other.resolution_;
  map_ = other.map_;
  target_is_map_ = other.target_is_map_;
  aligner_ = other.aligner_;
  result_ = other.result_;
  // PCL makes the indices of a whole cloud anew in place, where a source has another size.
  if (this->fake_indices_) this->indices_.reset();
  this->tree_.reset(new LazyKdTree<PointTarget>());
  if (this->target_) this->tree_->setInputCloud(this->target_);
}

template <typename PointSource, typename PointTarget, typename Scalar>
void WeightedNormalDistributionsTransform<PointSource, PointTarget, Scalar>::setInputTarget(
    const PointCloudTargetConstPtr& cloud) {
  if (!cloud) throw std::invalid_argument("setInputTarget: the cloud is a null pointer");
  buildTarget(*cloud);
  this->target_ = cloud;
  this->target_cloud_updated_ = true;
  target_is_map_ = false;
}

template <typename PointSource, typename PointTarget, typename Scalar>
void WeightedNormalDistributionsTransform<PointSource, PointTarget, Scalar>::setInputSource(
    const PointCloudSourceConstPtr& cloud) {
  if (!cloud) throw std::invalid_argument("setInputSource: the cloud is a null pointer");
  this->source_cloud_updated_ = true;
  pcl::PCLBase<PointSource>::setInputCloud(cloud);
}

template <typename PointSource, typename PointTarget, typename Scalar>
void WeightedNormalDistributionsTransform<PointSource, PointTarget, Scalar>::align(PointCloudSource& output,
                                                                                   const Matrix4& guess) {
  if (this->indices_ && !this->fake_indices_) internal::requireIndicesWithin(*this->indices_, this->input_->size());
  Base::align(output, guess);
}

template <typename PointSource, typename PointTarget, typename Scalar>
void WeightedNormalDistributionsTransform<PointSource, PointTarget, Scalar>::setTargetMap(const NdtTarget& map) {
  map_ = map;
  resolution_ = static_cast<float>(map.resolution());
  target_is_map_ = true;
  // pcl::Registration will not align without a target cloud.
  auto means = pcl::make_shared<PointCloudTarget>();
  means->reserve(map.voxelCount());
  for (const Eigen::Vector3d& mean : map.means()) {
    PointTarget point;
    point.getVector3fMap() = mean.template cast<float>();
    means->push_back(point);
  }
  this->target_ = means;
  this->target_cloud_updated_ = true;
}

template <typename PointSource, typename PointTarget, typename Scalar>
void WeightedNormalDistributionsTransform<PointSource, PointTarget, Scalar>::buildTarget(
    const PointCloudTarget& cloud) {
  bool labels_count = true;
  if constexpr (pcl::traits::has_label<PointTarget>::value) {
    labels_count = options_.use_weights || std::all_of(cloud.begin(), cloud.end(), [](const PointTarget& point) {
                     return point.label < kStructuralLabelCount;
                   });
  }
  WeightedMapBuilder builder(resolution_);
  builder.addScan(viewOf(cloud), labels_count ? labelsOf(cloud) : LabelView(), Eigen::Isometry3d::Identity(),
                  options_.threads);
  map_ =
      NdtTarget(std::move(builder).build(), weighting_, options_.threads,
                options_.arithmetic == Arithmetic::DOUBLE ? CellPrecision::SINGLE_AND_DOUBLE : CellPrecision::SINGLE);
}

template <typename PointSource, typename PointTarget, typename Scalar>
void WeightedNormalDistributionsTransform<PointSource, PointTarget, Scalar>::rebuildTarget() {
  if (this->target_ && !target_is_map_) buildTarget(*this->target_);
}

template <typename PointSource, typename PointTarget, typename Scalar>
void WeightedNormalDistributionsTransform<PointSource, PointTarget, Scalar>::setResolution(float resolution) {
  checkOption(resolution > 0.0f && std::isfinite(resolution), "resolution", resolution, "positive");
  if (resolution == resolution_) return;
  if (target_is_map_) {
    throw std::logic_error("setResolution: the target is a map of resolution " + std::to_string(resolution_));
  }
  resolution_ = resolution;
  rebuildTarget();
}

template <typename PointSource, typename PointTarget, typename Scalar>
void WeightedNormalDistributionsTransform<PointSource, PointTarget, Scalar>::setMinPointPerVoxel(
    unsigned int min_points_per_voxel) {
  VoxelWeighting weighting = weighting_;
  weighting.min_points_per_voxel = static_cast<int>(min_points_per_voxel);
  setVoxelWeighting(weighting);
}

template <typename PointSource, typename PointTarget, typename Scalar>
void WeightedNormalDistributionsTransform<PointSource, PointTarget, Scalar>::setVoxelWeighting(
    const VoxelWeighting& weighting) {
  weighting.check();
  weighting_ = weighting;
  rebuildTarget();
}

template <typename PointSource, typename PointTarget, typename Scalar>
void WeightedNormalDistributionsTransform<PointSource, PointTarget, Scalar>::setAlignmentOptions(
    const AlignmentOptions& options) {
  options.check();
  takeOptions(options);
}

template <typename PointSource, typename PointTarget, typename Scalar>
void WeightedNormalDistributionsTransform<PointSource, PointTarget, Scalar>::setUseWeights(bool use_weights) {
  AlignmentOptions options = options_;
  options.use_weights = use_weights;
  takeOptions(options);
}

template <typename PointSource, typename PointTarget, typename Scalar>
void WeightedNormalDistributionsTransform<PointSource, PointTarget, Scalar>::setNumberOfThreads(unsigned int threads) {
  constexpr auto kMost = static_cast<unsigned int>(std::numeric_limits<int>::max());
  options_.threads = static_cast<int>(std::min(threads, kMost));
}

template <typename PointSource, typename PointTarget, typename Scalar>
void WeightedNormalDistributionsTransform<PointSource, PointTarget, Scalar>::takeOptions(
    const AlignmentOptions& options) {
  const AlignmentOptions former = std::exchange(options_, options);
  const bool lacks_labels =
      pcl::traits::has_label<PointTarget>::value && options.use_weights && !former.use_weights && !map_.labelled();
  if (!lacks_labels && options.arithmetic == former.arithmetic) return;
  try {
    rebuildTarget();
  } catch (...) {
    options_ = former;
    throw;
  }
}

template <typename PointSource, typename PointTarget, typename Scalar>
void WeightedNormalDistributionsTransform<PointSource, PointTarget, Scalar>::convertTransform(
    const Eigen::Matrix<double, 6, 1>& x, Affine3& trans) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = x.head<3>();
  T.linear() = rotationFromEuler(x.tail<3>());
  trans.matrix() = T.matrix().template cast<Scalar>();
}

template <typename PointSource, typename PointTarget, typename Scalar>
void WeightedNormalDistributionsTransform<PointSource, PointTarget, Scalar>::convertTransform(
    const Eigen::Matrix<double, 6, 1>& x, Matrix4& trans) {
  Affine3 affine;
  convertTransform(x, affine);
  trans = affine.matrix();
}

template <typename PointSource, typename PointTarget, typename Scalar>
SourcePoints WeightedNormalDistributionsTransform<PointSource, PointTarget, Scalar>::selectedSource() const {
  constexpr bool kLabelled = pcl::traits::has_label<PointSource>::value;
  internal::requireIndicesWithin(*this->indices_, this->input_->size());
  SourcePoints points;
  points.labelled = kLabelled && options_.use_weights && map_.labelled();
  points.reserve(this->indices_->size());
  for (const auto index : *this->indices_) {
    const PointSource& point = (*this->input_)[static_cast<std::size_t>(index)];
    if (!isWithinReach(point.x, point.y, point.z)) continue;
    StructuralLabel label = StructuralLabel::NON_GROUND;
    if constexpr (kLabelled) {
      if (points.labelled) {
        label = structuralLabelFromValue(point.label);
        if (map_.weighting().confidence.of(label) <= 0.0) continue;
      }
    }
    points.add(point.x, point.y, point.z, label);
  }
  return points;
}

template <typename PointSource, typename PointTarget, typename Scalar>
AlignmentOptions WeightedNormalDistributionsTransform<PointSource, PointTarget, Scalar>::effectiveOptions() const {
  AlignmentOptions options = options_;
  options.max_iterations = std::max(1, this->max_iterations_);
  const double translation = this->transformation_epsilon_;
  const double cosine = this->transformation_rotation_epsilon_;
  if (options.optimizer == Optimizer::NEWTON_MORE_THUENTE) {
    constexpr double kNever = 1e300;
    options.translation_epsilon_m = translation > 0.0 ? std::sqrt(translation) : kNever;
    options.rotation_epsilon_rad = cosine > 0.0 ? std::max(1e-12, std::acos(std::min(cosine, 1.0))) : kNever;
    if (translation <= 0.0 && cosine <= 0.0) options.translation_epsilon_m = 1e-300;
    options.line_search_min_step = std::max(0.0, translation / 2.0);
  } else {
    const AlignmentOptions defaults;
    if (translation > 0.0) options.translation_epsilon_m = std::min(translation, defaults.translation_epsilon_m);
    if (cosine > 0.0 && cosine < 1.0) {
      options.rotation_epsilon_rad = std::min(std::acos(cosine), defaults.rotation_epsilon_rad);
    }
  }
  return options;
}

template <typename PointSource, typename PointTarget, typename Scalar>
void WeightedNormalDistributionsTransform<PointSource, PointTarget, Scalar>::computeTransformation(
    PointCloudSource& output, const Matrix4& guess) {
  if (!guess.allFinite()) throw std::invalid_argument("the initial guess is not finite");
  Eigen::Isometry3d T_target_source = Eigen::Isometry3d::Identity();
  T_target_source.matrix().template topRows<3>() = guess.template topRows<3>().template cast<double>();
  T_target_source = normalizedRotation(T_target_source);
  result_ = aligner_.align(map_, selectedSource(), T_target_source, effectiveOptions());

  this->converged_ = result_.converged();
  this->nr_iterations_ = result_.iterations;
  this->final_transformation_ = result_.T_map_source.matrix().template cast<Scalar>();
  this->transformation_ = this->final_transformation_;
  pcl::transformPointCloud(output, output, this->final_transformation_);
}

}  // namespace saw_ndt
