#pragma once

#include <pcl/filters/filter_indices.h>
#include <pcl/point_cloud.h>
#include <pcl/types.h>

#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/common/labels.h"
#include "saw_ndt/segmentation/ground_sampler.h"

namespace saw_ndt {

/// Keeps the share of ground points that GroundSampler tells, and every other point, noise included. Labels come from
/// setLabels(), or else from the `label` field of the points. Compiled for pcl::PointXYZ, PointXYZI and PointXYZL; for
/// other types include impl/ground_subsampling.hpp. One object is not to be shared by threads; the cloud may be.
template <typename PointT>
class SAW_NDT_EXPORT GroundSubsampling : public pcl::FilterIndices<PointT> {
 public:
  using PointCloud = pcl::PointCloud<PointT>;
  using Ptr = pcl::shared_ptr<GroundSubsampling<PointT>>;
  using ConstPtr = pcl::shared_ptr<const GroundSubsampling<PointT>>;

  /// @param extract_removed_indices  whether getRemovedIndices() is filled
  explicit GroundSubsampling(bool extract_removed_indices = false);

  /// Throws std::invalid_argument where an option is out of its limits; the former options then stay.
  void setOptions(const GroundSubsamplingOptions& options);
  const GroundSubsamplingOptions& getOptions() const { return options_; }

  /// One label per point of the input cloud, in input order. Empty labels: the `label` field of the points is used
  /// again. filter() throws std::invalid_argument where the number of labels is not that of the input's points, and
  /// where points without a `label` field meet no labels.
  void setLabels(const std::vector<StructuralLabel>& labels) { labels_ = labels; }

 protected:
  using pcl::FilterIndices<PointT>::applyFilter;
  void applyFilter(pcl::Indices& indices) override;

 private:
  bool isGround(pcl::index_t index) const;

  GroundSubsamplingOptions options_;
  std::vector<StructuralLabel> labels_;
};

}  // namespace saw_ndt
