#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>

#include "io/pcd_ascii.h"
#include "io/pcd_cloud.h"
#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

/// Reads a PCD file or, where the name says so, a PLY file block by block, in memory for one block whatever the size of
/// the file. A compressed PCD file can only be unpacked as a whole: one of more than kMostUnpackedBytes is refused.
class SAW_NDT_EXPORT CloudBlocks {
 public:
  static constexpr std::uint64_t kMostUnpackedBytes = 1ULL << 31U;

  /// Reads the head. Throws Error that names the line or the offset, also where the file's name ends in neither .pcd
  /// nor .ply.
  /// @param block_points  most points of a block, 1 or more
  CloudBlocks(const std::filesystem::path& path, std::size_t block_points);
  CloudBlocks(const CloudBlocks&) = delete;  // rows_ reads from stream_
  CloudBlocks& operator=(const CloudBlocks&) = delete;

  const std::filesystem::path& path() const { return path_; }
  const PcdHeader& header() const { return header_; }
  /// Number of the first point, from 0, of the block that next() gave last.
  std::uint64_t firstPoint() const { return first_; }

  /// Gives the next points as an unorganized cloud of all fields; false behind the last one. Throws Error as
  /// readCloudFile() does.
  bool next(PcdCloud& block);

 private:
  void takeUnpacked(PcdCloud& block, std::size_t size);

  std::filesystem::path path_;
  std::size_t block_points_;
  PcdHeader header_;
  bool big_endian_ = false;
  std::ifstream stream_;
  std::optional<PcdAsciiRows> rows_;
  PcdCloud unpacked_;  // of a compressed file, all of it
  std::uint64_t first_ = 0, read_ = 0;
};

}  // namespace saw_ndt::internal
