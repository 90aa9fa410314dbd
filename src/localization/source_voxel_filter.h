#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/common/labels.h"
#include "saw_ndt/common/scan_view.h"
#include "saw_ndt/map/voxel_weighting.h"
#include "saw_ndt/registration/source_points.h"
#include "saw_ndt/segmentation/ground_sampler.h"

namespace saw_ndt::internal {

struct ScanClock;
struct SourceVoxelBlock;

/// Which points of a scan become source points, and where they lie.
struct SourceSelection {
  double ground_ratio = 1.0;     ///< share of the ground points kept, 0 to 1; see GroundSampler
  ConfidenceOptions confidence;  ///< points of a label whose confidence is 0 are left out
  Eigen::Isometry3d T_base_lidar = Eigen::Isometry3d::Identity();  ///< from the scan's frame to that of the source
  const ScanClock* clock = nullptr;                                ///< of the scan's times, where times_s() is wanted
};

/// Makes a source of a scan: selects its points, brings them into the frame of the source, and thins them to one
/// centroid for every voxel and label, so that no centroid mixes labels. Keeps its scratch memory between calls.
class SAW_NDT_EXPORT SourceVoxelFilter {
 public:
  /// @param voxel_size_m  edge of a voxel; 0 keeps every point as it is
  /// @throws std::invalid_argument where it is negative or not finite
  explicit SourceVoxelFilter(double voxel_size_m);
  ~SourceVoxelFilter();
  SourceVoxelFilter(SourceVoxelFilter&& other) noexcept;
  SourceVoxelFilter& operator=(SourceVoxelFilter&& other) noexcept;

  /// The centroids in the order in which their voxels were first met, valid until the next call. Points that are not
  /// finite, or 2^19 voxels or more from the origin of the source's frame along an axis, are passed over.
  /// @param labels  one a point of the scan; null: none are known, and every point counts as NonGround
  /// @throws std::invalid_argument where the number of labels is not that of the points, or the ground ratio is out of
  ///         its limits
  const SourcePoints& filter(const ScanView& scan, const std::vector<StructuralLabel>* labels,
                             const SourceSelection& selection = SourceSelection());
  /// When each of them was measured (s, from the stamp), the mean of the points of its voxel; empty without a clock.
  const std::vector<float>& times_s() const { return times_s_; }

 private:
  std::size_t select(const ScanView& scan, std::size_t begin, std::size_t end, const StructuralLabel* labels,
                     const ScanClock* clock, GroundSampler& ground_sampler);
  void readTimes(const ScanView& scan, const ScanClock& clock, std::size_t begin, std::size_t count,
                 const std::uint16_t* taken);
  void addPoints(std::size_t count, bool timed);
  void addToVoxels(std::size_t count, bool timed);
  void numberVoxels(std::size_t count, const std::uint64_t* keys, std::uint32_t* numbers);
  void growTable();
  void startVoxels();
  void finishVoxels(bool timed);

  double voxel_size_m_;
  float inverse_size_ = 0.0F;
  std::array<bool, kStructuralLabelCount> takes_label_{};
  std::unique_ptr<SourceVoxelBlock> block_;
  /// By the hash of a key the number of its voxel, counted on from source to source: what is below first_number_ is of
  /// an earlier one, and the slot is empty.
  std::vector<std::uint32_t> slots_;
  int hash_shift_ = 0;
  std::uint32_t first_number_ = 0;
  std::uint32_t voxel_count_ = 0;
  std::vector<std::uint64_t> keys_;  ///< of each voxel
  std::vector<float> offset_sums_;   ///< of each voxel: x, y, z (m) and the number of points
  SourcePoints points_;
  std::vector<float> block_times_s_;  ///< of the points of the block
  std::vector<float> times_s_;        ///< of points_; before they are finished, sums
};

}  // namespace saw_ndt::internal
