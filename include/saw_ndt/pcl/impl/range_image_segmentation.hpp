#pragma once

#include <limits>
#include <pcl/filters/impl/filter_indices.hpp>
#include <pcl/impl/pcl_base.hpp>
#include <stdexcept>

#include "saw_ndt/pcl/cloud_view.h"
#include "saw_ndt/pcl/impl/checked_indices.h"
#include "saw_ndt/pcl/range_image_segmentation.h"

namespace saw_ndt {
template <typename PointT>
RangeImageSegmentation<PointT>::RangeImageSegmentation(bool extract_removed_indices)
    : pcl::FilterIndices<PointT>(extract_removed_indices) {
  this->filter_name_ = "RangeImageSegmentation";
}

template <typename PointT>
void RangeImageSegmentation<PointT>::setOptions(const SegmentationOptions& options) {
  segmenter_ = ScanSegmenter(options);
}

template <typename PointT>
ScanView RangeImageSegmentation<PointT>::selectedInput() {
  const PointCloud& input = *this->input_;
  ScanView scan = viewOf(input);
  if (!this->fake_indices_) {
    internal::requireIndicesWithin(*this->indices_, input.size());
    // Points that are not selected become no returns, so that rows and file order stay what they are.
    selected_xyz_.assign(3 * input.size(), std::numeric_limits<float>::quiet_NaN());
    for (const pcl::index_t index : *this->indices_) {
      const PointT& point = input[index];
      const std::size_t offset = 3 * static_cast<std::size_t>(index);
      selected_xyz_[offset] = point.x;
      selected_xyz_[offset + 1] = point.y;
      selected_xyz_[offset + 2] = point.z;
    }
    scan.xyz = selected_xyz_.data();
    scan.stride = 3;
  }
  return scan;
}

template <typename PointT>
void RangeImageSegmentation<PointT>::labelInput() {
  segmenter_.segment(selectedInput(), labels_);
}

template <typename PointT>
void RangeImageSegmentation<PointT>::applyFilter(pcl::Indices& indices) {
  labelInput();
  // Built aside: the caller may have passed the very indices that select the input.
  pcl::Indices kept;
  pcl::Indices removed;
  kept.reserve(this->indices_->size());
  for (const pcl::index_t index : *this->indices_) {
    const bool is_noise = labels_[index] == StructuralLabel::NOISE;
    if (is_noise == this->negative_) {
      kept.push_back(index);
    } else if (this->extract_removed_indices_) {
      removed.push_back(index);
    }
  }
  indices = std::move(kept);
  *this->removed_indices_ = std::move(removed);
}

template <typename PointT>
void RangeImageSegmentation<PointT>::segment(pcl::PointCloud<pcl::PointXYZL>& output) {
  if (!this->initCompute()) {
    labels_.clear();
    output = pcl::PointCloud<pcl::PointXYZL>();
    return;
  }
  labelInput();
  const PointCloud& input = *this->input_;
  pcl::PointCloud<pcl::PointXYZL> labelled;
  labelled.header = input.header;
  labelled.sensor_origin_ = input.sensor_origin_;
  labelled.sensor_orientation_ = input.sensor_orientation_;
  labelled.resize(input.size());
  labelled.width = input.width;
  labelled.height = input.height;
  labelled.is_dense = input.is_dense;
  for (std::size_t i = 0; i < input.size(); ++i) {
    labelled[i].x = input[i].x;
    labelled[i].y = input[i].y;
    labelled[i].z = input[i].z;
    labelled[i].label = static_cast<std::uint32_t>(labels_[i]);
  }
  output = std::move(labelled);
  this->deinitCompute();
}

}  // namespace saw_ndt

#define SAW_NDT_INSTANTIATE_RangeImageSegmentation(T) template class saw_ndt::RangeImageSegmentation<T>;
