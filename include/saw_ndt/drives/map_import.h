#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/map/weighted_map_builder.h"

namespace saw_ndt {

/// Where the labels of an imported cloud come from.
enum class ImportedLabels {
  AUTO,    ///< the field `label` where all of its values are those of StructuralLabel, else none
  NONE,    ///< none: a map for the method `classical`
  HEIGHTS  ///< told from the cloud: ground is what lies close above the lowest surface around
};

struct MapImportOptions {
  double resolution_m = 0.5;  ///< edge of a voxel
  ImportedLabels labels = ImportedLabels::AUTO;
  /// Taken off all coordinates (m); none: where they are beyond 100 km, the multiple of 1000 m next to the first
  /// points.
  std::optional<std::array<double, 3>> origin_m;
  std::size_t block_points = 262144;  ///< points in memory at once; the map does not depend on it
  int threads = 0;                    ///< 0: all cores; the map does not depend on it

  /// Throws std::invalid_argument that names the field and its value.
  SAW_NDT_EXPORT void check() const;
};

/// A map of clouds and what was met in them.
struct ImportedMap {
  WeightedMapBuilder builder;  ///< all points as those of one scan
  std::array<double, 3>
      origin_m{};  ///< what was taken off: a position of the clouds is one of the map plus this; the map tells it
  std::uint64_t points_read = 0;          ///< in all files
  std::uint64_t points_not_finite = 0;    ///< passed over: NaN or infinite
  std::uint64_t points_at_zero = 0;       ///< passed over: (0, 0, 0), which drivers write for no return
  std::size_t files = 0;                  ///< read
  std::string why_unlabelled;             ///< why the labels of a file were not taken; empty where they were
  std::vector<std::string> files_beside;  ///< clouds in the folder that its metadata do not name, left out
};

/// Makes a map of a point cloud map: of one PCD or PLY file of any size, of a folder with Autoware's
/// pointcloud_map_metadata.yaml (the tiles that it names, in the folder or in its pointcloud_map.pcd), or of all PCD
/// and PLY files of a folder. Files are read in blocks, twice where heights tell the labels; a compressed PCD file has
/// to be unpacked as a whole. Coordinates are read as double, and rounded to float once the origin has been taken off.
/// The map is that of one scan with all points, to the byte, but for the origin that it tells.
/// @throws Error that names the file and the place: for a missing, damaged or foreign one, one without x, y and z, a
///         tile that is missing, or where no point is left. std::invalid_argument for options that do not hold
SAW_NDT_EXPORT ImportedMap importMap(const std::filesystem::path& cloud, const MapImportOptions& options = {});

}  // namespace saw_ndt
