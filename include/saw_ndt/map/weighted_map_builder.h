#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/common/labels.h"
#include "saw_ndt/common/scan_view.h"
#include "saw_ndt/map/weighted_voxel_map.h"
#include "saw_ndt/map/written_map.h"
#include "saw_ndt/segmentation/segmentation_options.h"

namespace saw_ndt {

namespace internal {
class SpilledTiles;
class VoxelSumsTable;
}  // namespace internal

/// Collects labelled points into voxel sums, scan after scan. Memory grows with the voxels met, never with the
/// points; the result does not depend on the order of scans or on how they were spread over builders. Not to be shared
/// by threads: each may have a builder of its own, and one of them merges the others.
class SAW_NDT_EXPORT WeightedMapBuilder {
 public:
  /// @param resolution_m  edge of a voxel, positive
  /// @param segmentation  how the labels of the scans were made, where that is known: the map tells it
  /// @throws std::invalid_argument
  explicit WeightedMapBuilder(double resolution_m, std::optional<SegmentationOptions> segmentation = std::nullopt);
  ~WeightedMapBuilder();
  WeightedMapBuilder(const WeightedMapBuilder& other);
  WeightedMapBuilder(WeightedMapBuilder&& other) noexcept;
  WeightedMapBuilder& operator=(const WeightedMapBuilder& other);
  WeightedMapBuilder& operator=(WeightedMapBuilder&& other) noexcept;

  /// Tells where the map frame's origin lies in the frame that the points are given in (see MapOrigin).
  /// @throws std::invalid_argument where it is not finite
  void setMapOrigin(const Eigen::Vector3d& map_origin_m);

  /// Adds the points of a scan that are finite and not (0, 0, 0), which drivers write for no return. With labels the
  /// points count under them, without any the map becomes an unlabelled one; scans of the two kinds do not mix.
  /// addCloud() of pcl/cloud_view.h adds clouds of PCL.
  /// @param labels      of each point of the scan, values of StructuralLabel
  /// @param T_map_scan  pose of the scan's frame in the map frame
  /// @param threads     0: all cores; the result does not depend on it
  /// @throws std::invalid_argument for a pose that is not finite, a label that is none, mixed kinds, or no labels where
  /// their segmentation has been given
  void addScan(const ScanView& scan, const LabelView& labels, const Eigen::Isometry3d& T_map_scan, int threads = 1);

  /// Adds further points of the scan that was added last, such as the next block of a cloud too large for the memory:
  /// the map is that of one scan with all of these points. Where none has been added, the same as addScan().
  void continueScan(const ScanView& scan, const LabelView& labels, const Eigen::Isometry3d& T_map_scan,
                    int threads = 1);

  /// Adds all that another builder has collected.
  /// @throws std::invalid_argument that names what differs, where resolution or segmentation are not the same
  void merge(const WeightedMapBuilder& other);
  /// Adds all that a map holds. The map of everything has the same bytes as one that its scans had been added to, but
  /// that the number of scans which met a voxel is not known where it is not known of a part, and the software version
  /// where the parts are of several.
  /// @throws std::invalid_argument as above, and where a voxel or the map would have more points or scans than there is
  /// room for; the builder is as it was then
  void merge(const WeightedVoxelMap& map);

  /// What has been added so far.
  const MapOrigin& origin() const { return origin_; }

  /// Where so many sums are in memory when a scan or a map comes, they go into a temporary file, tile by tile, and come
  /// together again when the map is built or saved: memory no longer grows with the map. The file has no name and goes
  /// with the builder, whatever ends the process.
  /// @param most_entries  one a voxel and label, some 130 bytes each; 1 or more
  /// @param folder        where there is room for what the map's file will take, and more where places are seen again
  /// @throws std::invalid_argument; Error where no file can be made. Adding and reading throws Error, too, from then on
  void limitMemory(std::size_t most_entries, const std::filesystem::path& folder);
  /// How many sums are in memory.
  std::size_t entryCount() const;

  /// The map of everything added so far.
  WeightedVoxelMap build() const&;
  /// The same without a copy of the sums; the builder is empty afterwards.
  WeightedVoxelMap build() &&;

  // The same of build()'s map without making it, in hardly more memory than the builder has. Both throw
  // std::invalid_argument where the sums of a voxel that have been in the temporary file are more than there is room
  // for.

  /// Calls visit(entries) for each tile that has any, in map order, with its entries in map order.
  /// @param threads  that read, besides the one that visits; 0: all cores
  void forEachTile(const std::function<void(const std::vector<LabelledVoxelSums>& entries)>& visit,
                   int threads = 1) const;
  /// Writes the map file of everything added so far.
  /// @param threads  0: all cores; the file does not depend on it
  /// @throws Error
  WrittenMap save(const std::string& path, int threads = 0) const;

 private:
  bool isEmpty() const;
  void requireKind(bool labelled) const;
  void requireAddable(const LabelView& labels, const Eigen::Isometry3d& T_map_scan) const;
  void requireRoomFor(const MapOrigin& origin, const std::vector<LabelledVoxelSums>& entries) const;
  void beginAdding(bool labelled, const std::string& software_version);
  void add(const std::vector<LabelledVoxelSums>& entries);
  bool hasSpilled() const;
  void spillWhereTooMany();
  void addPoints(const ScanView& points, const LabelView& labels, const Eigen::Isometry3d& T_map_scan, int threads);

  MapOrigin origin_;
  std::unique_ptr<internal::VoxelSumsTable> table_;
  std::size_t most_entries_ = 0;
  std::unique_ptr<internal::SpilledTiles> spilled_;  // none where memory is not limited
};

}  // namespace saw_ndt
