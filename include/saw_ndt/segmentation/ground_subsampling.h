#pragma once

#include <pcl/filters/filter_indices.h>
#include <pcl/point_cloud.h>
#include <pcl/types.h>

#include <cstdint>
#include <vector>

#include "saw_ndt/common/labels.h"

namespace saw_ndt {

/// Options of ground subsampling.
struct GroundSubsamplingOptions {
  /// Share of the ground points that is kept, 0 to 1; rho in section III.C of the paper.
  double ground_ratio = 0.5;

  /// Throws std::invalid_argument that names the field and its value.
  void check() const;
};

/// Which ground points of a scan are kept: ground point k, counted from 0 in scan order, where
/// floor((k + 1) rho) > floor(k rho). A ratio of 0.5 keeps every other one.
class GroundSampler {
 public:
  /// Throws std::invalid_argument where an option is out of its limits.
  explicit GroundSampler(const GroundSubsamplingOptions& options);

  /// Counts one more ground point and tells whether it is kept.
  bool keepsNext() { return keepsNext(true); }
  /// The same for one more point that may be no ground, which is not counted but kept. Without a branch.
  bool keepsNext(bool is_ground) {
    counted_ += static_cast<std::int64_t>(is_ground);
    const auto kept = static_cast<std::int64_t>(static_cast<double>(counted_) * ratio_);
    const bool keeps = !is_ground | (kept > kept_);
    kept_ = kept;
    return keeps;
  }

 private:
  double ratio_;
  std::int64_t counted_ = 0;
  std::int64_t kept_ = 0;
};

/// Writes the positions in `labels` of the points that subsampling keeps: the share of ground points that GroundSampler
/// tells, and every other point, noise included. Allocates nothing where `kept` has room. Throws as GroundSampler.
void subsampleGround(const std::vector<StructuralLabel>& labels, const GroundSubsamplingOptions& options,
                     pcl::Indices& kept);

/// The same as a PCL filter. Labels come from setLabels(), or else from the `label` field of the points. Compiled for
/// pcl::PointXYZ, PointXYZI and PointXYZL; for other types include impl/ground_subsampling.hpp.
template <typename PointT>
class GroundSubsampling : public pcl::FilterIndices<PointT> {
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
