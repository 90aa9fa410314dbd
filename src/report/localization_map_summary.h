#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "report/map_summary.h"
#include "saw_ndt/map/localization_map.h"

namespace saw_ndt {

/// What a localization map holds.
struct LocalizationMapSummary {
  MapOrigin origin;                   ///< of the map that it was packed from
  std::vector<std::string> methods;   ///< of saw_ndt_localize that it serves
  std::vector<double> resolutions_m;  ///< edges of the voxels of each level that matches
  double coarse_resolution_m = 0.0;   ///< of the coarse level; 0 without one
  std::vector<std::size_t> level_voxels;
  std::size_t coarse_voxels = 0;
  Eigen::Vector2d box_min_m = Eigen::Vector2d::Zero();  ///< lower corner of its tiles, map frame
  Eigen::Vector2d box_max_m = Eigen::Vector2d::Zero();  ///< upper corner
  double tile_m = 0.0;                                  ///< edge of a tile
  std::size_t tiles = 0;
  TileEntries tile_bytes;                     ///< of voxels and search table
  std::array<std::size_t, 3> class_voxels{};  ///< on the levels that match: linear, planar, volumetric
  std::uint64_t file_bytes = 0;
  std::uint64_t search_bytes = 0;  ///< of them, of search tables
};

/// Reads all of the map. @throws Error where a tile is damaged
LocalizationMapSummary summarize(const LocalizationMap& map);

/// A line a figure: its name in toJsonText(), then its value.
std::string toText(const LocalizationMapSummary& summary);
/// One JSON object, indented, with a line end.
std::string toJsonText(const LocalizationMapSummary& summary);

}  // namespace saw_ndt
