#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "saw_ndt/common/export.h"
#include "saw_ndt/map/ndt_target.h"

namespace saw_ndt {

namespace internal {
class LocalizationMapFile;
}

/// A map to localize in, as packMap() derives it from the sums of a WeightedVoxelMap for one weighting: quantized
/// voxels in tiles of 64 m, and what a search looks scans up in. The file is memory mapped: opening it reads the header
/// alone, a tile is read and checked when it is used, and processes that have the same file open share its memory. It
/// must not be written to while it is open; replacing it by another file, as packMap() does, is safe. A value:
/// immutable, cheap to copy, and safe to use from many threads.
class SAW_NDT_EXPORT LocalizationMap {
 public:
  /// @throws Error where the file is missing, damaged, truncated or foreign
  explicit LocalizationMap(const std::string& path);
  /// @throws Error that names the file where it was made with another weighting
  void requireWeighting(const VoxelWeighting& weighting) const;
  /// Whether a file begins as a localization map does; false where it cannot be read.
  static bool isOne(const std::string& path);

  const std::string& path() const;
  /// Of the map that it was derived from.
  const MapOrigin& origin() const;
  const VoxelWeighting& weighting() const;
  std::uint64_t voxelCount() const;        ///< on the levels that match
  std::uint64_t coarseVoxelCount() const;  ///< on the coarse one
  std::uint64_t tileCount() const;
  std::uint64_t fileSize() const;  ///< bytes

  /// All of its voxels. @throws Error where a tile is damaged. @param threads  0: all cores
  NdtTarget target(int threads = 0) const;
  /// The voxels whose middle lies within a horizontal distance of a position in the map frame (m).
  NdtTarget targetAround(const Eigen::Vector3d& position_m, double radius_m, int threads = 0) const;

  /// For this project's own code.
  const internal::LocalizationMapFile& file() const { return *file_; }

 private:
  std::shared_ptr<const internal::LocalizationMapFile> file_;
};

}  // namespace saw_ndt
