#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "common/mapped_file.h"
#include "map/localization_tile.h"
#include "map/map_front.h"
#include "saw_ndt/map/ndt_target.h"

namespace saw_ndt::internal {

/// Where a tile lies in a localization map.
struct LocalizationTilePlace {
  TileCoordinate at;
  std::uint64_t offset = 0;  ///< of its cells; its search table follows them
  std::uint32_t cell_bytes = 0;
  std::uint32_t cell_checksum = 0;
  std::uint32_t table_bytes = 0;
  std::uint32_t table_checksum = 0;
  std::uint32_t voxel_count = 0;
};

/// A localization map file (see localization_map_layout.h), memory mapped. Every failure is an Error that names the
/// file, the offset and the reason. Safe to use from many threads.
class SAW_NDT_EXPORT LocalizationMapFile {
 public:
  explicit LocalizationMapFile(const std::string& path);

  const std::string& path() const { return path_; }
  const MapOrigin& origin() const { return origin_; }
  const VoxelWeighting& weighting() const { return weighting_; }
  /// Edges of the voxels of the levels that match, and of the coarse one where there is one (m).
  const std::vector<double>& resolutions() const { return resolutions_m_; }
  std::uint64_t voxelCount() const { return voxel_count_; }
  std::uint64_t coarseVoxelCount() const { return coarse_voxel_count_; }
  std::size_t tileCount() const { return tile_count_; }
  std::uint64_t size() const { return file_.size(); }
  const Eigen::Vector2d& least() const { return least_m_; }        ///< corner of what its tiles cover (m)
  const Eigen::Vector2d& greatest() const { return greatest_m_; }  ///< likewise

  /// The tile of a number: they are ordered by y, x.
  LocalizationTilePlace tile(std::size_t number) const;
  /// The number of the first tile that does not come before a coordinate; tileCount() where all do.
  std::size_t firstFrom(const TileCoordinate& at) const;
  /// All tiles, ordered.
  std::vector<LocalizationTilePlace> allTiles() const;
  /// The tiles that reach within a horizontal distance of a position (m).
  std::vector<LocalizationTilePlace> tilesAround(const Eigen::Vector2d& position_m, double radius_m) const;

  /// The target of some tiles, in their order.
  NdtTarget targetOf(const std::vector<LocalizationTilePlace>& tiles, int threads,
                     const LocalizationClip& clip = {}) const;
  /// The voxels of a tile as they stand in the file.
  std::string_view cells(const LocalizationTilePlace& tile) const;
  /// Calls visit(level, cell) for each voxel of a tile, as forEachCell().
  void forEachCellOf(const LocalizationTilePlace& tile,
                     const std::function<void(std::size_t level, const QuantizedCell& cell)>& visit) const;
  /// The search table of a tile as it stands in the file; empty where there is none.
  std::string_view searchTable(const LocalizationTilePlace& tile) const;

 private:
  [[noreturn]] void fail(std::uint64_t offset, const std::string& reason) const { failAt(path_, offset, reason); }
  [[noreturn]] void failOutOfOrder(std::size_t number) const;
  void requireDisjoint(const std::vector<LocalizationTilePlace>& tiles) const;
  void requireCells(bool are_valid, const LocalizationTilePlace& tile) const;
  void readHeader();
  void readMetadata(std::uint32_t size, std::uint32_t checksum);
  void decode(const LocalizationTilePlace& tile, const LocalizationClip& clip, std::vector<NdtCells>& cells) const;

  std::string path_;
  MappedFile file_;
  MapOrigin origin_;
  VoxelWeighting weighting_;
  std::vector<double> resolutions_m_;  // of the levels that match, and of the coarse one where there is one
  std::uint64_t voxel_count_ = 0;
  std::uint64_t coarse_voxel_count_ = 0;
  std::size_t tile_count_ = 0;
  std::uint64_t tiles_offset_ = 0;
  std::uint64_t directory_offset_ = 0;
  Eigen::Vector2d least_m_ = Eigen::Vector2d::Zero(), greatest_m_ = Eigen::Vector2d::Zero();
};

}  // namespace saw_ndt::internal
