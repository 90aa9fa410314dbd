#pragma once

#include <cstdint>
#include <vector>

#include "saw_ndt/map/voxel_weighting.h"
#include "saw_ndt/registration/source_points.h"

namespace saw_ndt::internal {

struct BatchPoints;

/// Source points in an order in which those that meet the same voxel of a map follow each other, so that matching looks
/// a voxel up, and loads it, once for all of them: column by column of the source's own space, and voxel by voxel
/// within batches of points, which matching sees to wherever a pose has mixed them up. The order is a matter of speed
/// alone. Memory is kept between uses.
class OrderedSource {
 public:
  /// Takes points over.
  /// @param resolution_m  edge of a voxel of the map
  /// @param confidence    s of a point by its label
  /// @param threads       the order does not depend on it
  void order(const SourcePoints& source, double resolution_m, const ConfidenceOptions& confidence, int threads = 1);
  /// Takes over every `stride`-th point of another.
  void thin(const OrderedSource& source, std::size_t stride);

  /// Deals the points out by their marks: those of mark m to part m, which is taken to be in order.
  /// @param marks    one a point, each below `count`, which is 16 at most
  /// @param threads  the parts do not depend on it
  void split(const std::vector<std::uint8_t>& marks, std::size_t count, int threads,
             std::vector<OrderedSource>& parts) const;

  std::size_t size() const { return size_; }

  /// Coordinates (m, source frame), confidences, and 1 for what is not labelled ground, otherwise 0; behind the last
  /// point there is room for vectors.
  const float* x() const { return x_.data(); }
  const float* y() const { return y_.data(); }
  const float* z() const { return z_.data(); }
  const float* confidence() const { return confidence_.data(); }
  const float* nonGround() const { return non_ground_.data(); }
  std::size_t nonGroundCount() const { return non_ground_count_; }

  /// Whether so many runs are many more than the batch that begins at point `first` had when it was last put in order.
  bool mixedUp(std::size_t first, std::size_t run_count) const;
  /// Puts the points of a batch, which begins at point `first`, in an order in which runs of one voxel follow each
  /// other. Different batches may be put in order at the same time.
  void regroup(std::size_t first, const BatchPoints& batch);

 private:
  void resize(std::size_t size);

  std::size_t size_ = 0;
  std::size_t non_ground_count_ = 0;
  std::vector<float> x_, y_, z_, confidence_, non_ground_;
  std::vector<std::uint32_t> groups_of_batch_;  // 0: not put in order yet
  std::vector<std::uint16_t> columns_;
  std::vector<std::uint32_t> places_;
};

}  // namespace saw_ndt::internal
