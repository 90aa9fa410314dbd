#pragma once

#include <pcl/search/kdtree.h>

#include <limits>
#include <mutex>

#include "saw_ndt/registration/source_points.h"

namespace saw_ndt {

/// A k-d tree that is built by its first query. pcl::Registration::align() hands every new target to its tree, which
/// NDT never asks; only getFitnessScore() does. Threads may ask it at the same time.
template <typename PointT>
class LazyKdTree : public pcl::search::KdTree<PointT> {
  using Base = pcl::search::KdTree<PointT>;

 public:
  using Base::nearestKSearch;
  using Base::radiusSearch;
  using typename Base::PointCloudConstPtr;
  using IndicesConstPtr = typename pcl::search::Search<PointT>::IndicesConstPtr;

  void setInputCloud(const PointCloudConstPtr& cloud, const IndicesConstPtr& indices = IndicesConstPtr()) override {
    this->input_ = cloud;
    this->indices_ = indices;
    built_ = false;
  }

  /// As the base, but a query that is not within reach, or a cloud without such a point, has no neighbour: returns 0,
  /// and distances are infinite.
  int nearestKSearch(const PointT& point, int k, pcl::Indices& indices,
                     std::vector<float>& squared_distances) const override {
    if (build() && isWithinReach(point.x, point.y, point.z))
      return Base::nearestKSearch(point, k, indices, squared_distances);
    indices.assign(1, 0);
    squared_distances.assign(1, std::numeric_limits<float>::infinity());
    return 0;
  }

  int radiusSearch(const PointT& point, double radius, pcl::Indices& indices, std::vector<float>& squared_distances,
                   unsigned int max_nn = 0) const override {
    if (build() && isWithinReach(point.x, point.y, point.z))
      return Base::radiusSearch(point, radius, indices, squared_distances, max_nn);
    indices.clear();
    squared_distances.clear();
    return 0;
  }

 private:
  bool build() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!built_) {
      const IndicesConstPtr indices = pointsWithinReach();
      has_points_ = indices != nullptr;
      if (has_points_) const_cast<LazyKdTree*>(this)->Base::setInputCloud(this->input_, indices);
      built_ = true;
    }
    return has_points_;
  }

  // Null where there are none. Between points farther apart FLANN finds no middle and ends the process.
  IndicesConstPtr pointsWithinReach() const {
    auto within = pcl::make_shared<pcl::Indices>();
    const auto add = [&](pcl::index_t index) {
      const PointT& point = (*this->input_)[index];
      if (isWithinReach(point.x, point.y, point.z)) within->push_back(index);
    };
    if (this->indices_) {
      for (const pcl::index_t index : *this->indices_) add(index);
    } else if (this->input_) {
      for (std::size_t i = 0; i < this->input_->size(); ++i) add(static_cast<pcl::index_t>(i));
    }
    return within->empty() ? nullptr : within;
  }

  mutable std::mutex mutex_;
  mutable bool built_ = false;
  mutable bool has_points_ = false;
};

}  // namespace saw_ndt
