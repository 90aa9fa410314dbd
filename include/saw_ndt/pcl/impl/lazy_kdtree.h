#pragma once

#include <pcl/search/kdtree.h>

#include <limits>
#include <mutex>

namespace saw_ndt {

/// A k-d tree that is built by its first query. pcl::Registration::align() hands every new target to its tree, which
/// NDT never asks; only getFitnessScore() does.
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

  /// As the base, but a query that is not finite, or an empty cloud, has no neighbour: returns 0, and distances are
  /// infinite.
  int nearestKSearch(const PointT& point, int k, pcl::Indices& indices,
                     std::vector<float>& squared_distances) const override {
    if (build() && pcl::isFinite(point)) return Base::nearestKSearch(point, k, indices, squared_distances);
    indices.assign(1, 0);
    squared_distances.assign(1, std::numeric_limits<float>::infinity());
    return 0;
  }

  int radiusSearch(const PointT& point, double radius, pcl::Indices& indices, std::vector<float>& squared_distances,
                   unsigned int max_nn = 0) const override {
    if (build() && pcl::isFinite(point)) return Base::radiusSearch(point, radius, indices, squared_distances, max_nn);
    indices.clear();
    squared_distances.clear();
    return 0;
  }

 private:
  bool build() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!built_) {
      has_points_ = false;
      if (this->input_) {
        for (const PointT& point : *this->input_) has_points_ = has_points_ || pcl::isFinite(point);
      }
      if (has_points_) const_cast<LazyKdTree*>(this)->Base::setInputCloud(this->input_, this->indices_);
      built_ = true;
    }
    return has_points_;
  }

  mutable std::mutex mutex_;
  mutable bool built_ = false;
  mutable bool has_points_ = false;
};

}  // namespace saw_ndt
