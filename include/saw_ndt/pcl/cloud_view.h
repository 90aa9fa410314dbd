#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <initializer_list>
#include <type_traits>

#include "saw_ndt/common/labels.h"
#include "saw_ndt/common/scan_view.h"
#include "saw_ndt/map/weighted_map_builder.h"

namespace saw_ndt {

namespace internal {

// The field that `member`, a generic lambda, returns the address of, where the point type has it. Drivers name theirs
// without registering them with PCL.
template <typename PointT, typename Member>
PointField fieldOf(const PointT& first, const Member& member, double scale_of_integers = 1.0) {
  if constexpr (std::is_invocable_v<const Member&, const PointT&>) {
    using Number = std::decay_t<decltype(*member(first))>;
    return PointField(member(first), sizeof(PointT), std::is_integral_v<Number> ? scale_of_integers : 1.0);
  } else {
    return {};
  }
}

inline PointField firstKnown(std::initializer_list<PointField> fields) {
  for (const PointField& field : fields) {
    if (field.known()) return field;
  }
  return {};
}

}  // namespace internal

/// A view of a cloud whose points have y and z behind x, as all of PCL's do. Ring numbers come from a member `ring` or
/// `channel` of the point type, times from `time`, `t`, `timestamp` or `offset_time`, where it has one: seconds in a
/// floating-point number, nanoseconds in an integer.
template <typename PointT>
ScanView viewOf(const pcl::PointCloud<PointT>& cloud) {
  static_assert(sizeof(PointT) % sizeof(float) == 0, "points must be a whole number of floats apart");
  ScanView view;
  view.stride = sizeof(PointT) / sizeof(float);
  view.size = cloud.size();
  view.width = cloud.width;
  view.height = cloud.height;
  if (cloud.empty()) return view;
  const PointT& first = cloud.front();
  view.xyz = &first.x;
  constexpr double kNanosecond_s = 1e-9;
  using internal::fieldOf;
  view.rings = internal::firstKnown(
      {fieldOf(first, [](const auto& point) -> decltype(&point.ring) { return &point.ring; }),
       fieldOf(first, [](const auto& point) -> decltype(&point.channel) { return &point.channel; })});
  view.times_s = internal::firstKnown(
      {fieldOf(
           first, [](const auto& point) -> decltype(&point.time) { return &point.time; }, kNanosecond_s),
       fieldOf(
           first, [](const auto& point) -> decltype(&point.t) { return &point.t; }, kNanosecond_s),
       fieldOf(
           first, [](const auto& point) -> decltype(&point.timestamp) { return &point.timestamp; }, kNanosecond_s),
       fieldOf(
           first, [](const auto& point) -> decltype(&point.offset_time) { return &point.offset_time; },
           kNanosecond_s)});
  return view;
}

/// The labels of a cloud of points with a `label` field; none where the type has no such field.
/// @throws std::invalid_argument for a value that is no StructuralLabel
template <typename PointT>
LabelView labelsOf(const pcl::PointCloud<PointT>& cloud) {
  LabelView labels;
  if constexpr (pcl::traits::has_label<PointT>::value) {
    for (const PointT& point : cloud) structuralLabelFromValue(point.label);
    static const std::uint8_t no_label = 0;
    // The low byte of a label is its value.
    labels.first = cloud.empty() ? &no_label : reinterpret_cast<const std::uint8_t*>(&cloud.front().label);
    labels.stride = sizeof(PointT);
  }
  return labels;
}

/// Adds the points of a cloud to a map that WeightedMapBuilder::addScan() adds, under the labels of their `label` field
/// where they have one.
/// @param T_map_cloud  pose of the cloud's frame in the map frame
/// @throws std::invalid_argument as labelsOf() and WeightedMapBuilder::addScan()
template <typename PointT>
void addCloud(WeightedMapBuilder& builder, const pcl::PointCloud<PointT>& cloud, const Eigen::Isometry3d& T_map_cloud,
              int threads = 1) {
  builder.addScan(viewOf(cloud), labelsOf(cloud), T_map_cloud, threads);
}

}  // namespace saw_ndt
