#pragma once

#include <pcl/filters/impl/filter_indices.hpp>
#include <pcl/impl/pcl_base.hpp>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include "saw_ndt/pcl/ground_subsampling.h"
#include "saw_ndt/pcl/impl/checked_indices.h"

namespace saw_ndt {
namespace detail {

template <typename PointT, typename = void>
struct HasLabel : std::false_type {};
template <typename PointT>
struct HasLabel<PointT, std::void_t<decltype(std::declval<PointT>().label)>> : std::true_type {};

}  // namespace detail

template <typename PointT>
GroundSubsampling<PointT>::GroundSubsampling(bool extract_removed_indices)
    : pcl::FilterIndices<PointT>(extract_removed_indices) {
  this->filter_name_ = "GroundSubsampling";
}

template <typename PointT>
void GroundSubsampling<PointT>::setOptions(const GroundSubsamplingOptions& options) {
  options.check();
  options_ = options;
}

template <typename PointT>
bool GroundSubsampling<PointT>::isGround(pcl::index_t index) const {
  if (!labels_.empty()) return labels_[index] == StructuralLabel::GROUND;
  if constexpr (detail::HasLabel<PointT>::value) {
    return (*this->input_)[index].label == static_cast<std::uint32_t>(StructuralLabel::GROUND);
  }
  return false;
}

template <typename PointT>
void GroundSubsampling<PointT>::applyFilter(pcl::Indices& indices) {
  const std::size_t points = this->input_->size();
  if (labels_.empty() ? !detail::HasLabel<PointT>::value && points > 0 : labels_.size() != points) {
    throw std::invalid_argument("labels: " + std::to_string(labels_.size()) + " for " + std::to_string(points) +
                                " points");
  }
  internal::requireIndicesWithin(*this->indices_, points);
  GroundSampler sampler(options_);
  // Built aside: the caller may have passed the very indices that select the input.
  pcl::Indices kept;
  pcl::Indices removed;
  kept.reserve(this->indices_->size());
  for (const pcl::index_t index : *this->indices_) {
    const bool keeps = !isGround(index) || sampler.keepsNext();
    if (keeps != this->negative_) {
      kept.push_back(index);
    } else if (this->extract_removed_indices_) {
      removed.push_back(index);
    }
  }
  indices = std::move(kept);
  *this->removed_indices_ = std::move(removed);
}

}  // namespace saw_ndt

#define SAW_NDT_INSTANTIATE_GroundSubsampling(T) template class saw_ndt::GroundSubsampling<T>;
