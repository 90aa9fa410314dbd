#pragma once

#include <pcl/filters/filter_indices.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <cstdint>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/common/labels.h"
#include "saw_ndt/segmentation/scan_segmenter.h"

namespace saw_ndt {

/// Range-image segmentation (section III.A of the paper) as a PCL filter: keeps ground and non-ground points of a scan
/// and removes noise. Input: one scan in the LiDAR frame (metres, x forward, y left, z up), best as the sensor gives
/// it: with its NaN points if organized, with a `ring` field, or in ring order; see RingIndex.
///
/// Of the points that setIndices() names, each is either kept or removed (setNegative() swaps the two). The others are
/// not looked at: their label is Noise. Compiled for pcl::PointXYZ, PointXYZI and PointXYZL; for other types include
/// impl/range_image_segmentation.hpp. One object is not to be shared by threads; the cloud may be.
template <typename PointT>
class SAW_NDT_EXPORT RangeImageSegmentation : public pcl::FilterIndices<PointT> {
 public:
  using PointCloud = pcl::PointCloud<PointT>;
  using Ptr = pcl::shared_ptr<RangeImageSegmentation<PointT>>;
  using ConstPtr = pcl::shared_ptr<const RangeImageSegmentation<PointT>>;

  /// @param extract_removed_indices  whether getRemovedIndices() is filled
  explicit RangeImageSegmentation(bool extract_removed_indices = false);

  /// Throws std::invalid_argument where an option is out of its limits; the former options then stay.
  void setOptions(const SegmentationOptions& options);
  const SegmentationOptions& getOptions() const { return segmenter_.options(); }

  /// The label of every point of the input cloud, in input order, as the last filter() or segment() found it.
  const std::vector<StructuralLabel>& getLabels() const { return labels_; }

  /// Writes every input point in input order with its StructuralLabel in the `label` field; width and height are those
  /// of the input. Without an input cloud the output is empty.
  void segment(pcl::PointCloud<pcl::PointXYZL>& output);

 protected:
  using pcl::FilterIndices<PointT>::applyFilter;
  void applyFilter(pcl::Indices& indices) override;

 private:
  void labelInput();
  ScanView selectedInput();

  ScanSegmenter segmenter_;
  std::vector<StructuralLabel> labels_;
  std::vector<float> selected_xyz_;
};

}  // namespace saw_ndt
