#include "drives/cloud_map_files.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <set>

#include "io/natural_order.h"
#include "io/tile_metadata.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

namespace fs = std::filesystem;

namespace {

constexpr char kMetadata[] = "pointcloud_map_metadata.yaml";
constexpr char kTileFolder[] = "pointcloud_map.pcd";  // Autoware's name for it, beside the metadata

struct NaturalOrder {
  bool operator()(const std::string& a, const std::string& b) const { return naturallyBefore(a, b); }
};
using Names = std::set<std::string, NaturalOrder>;

Names cloudsIn(const fs::path& folder) {
  Names names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const fs::path extension = entry.path().extension();
    if (entry.is_regular_file() && (extension == ".pcd" || extension == ".ply")) {
      names.insert(entry.path().filename().string());
    }
  }
  return names;
}

/// The metadata of a folder; empty where there are none.
fs::path metadataOf(const fs::path& folder) {
  if (fs::exists(folder / kMetadata)) return folder / kMetadata;
  const fs::path as_is = fs::weakly_canonical(folder);
  const fs::path above = as_is.parent_path() / kMetadata;
  return as_is.filename() == kTileFolder && fs::exists(above) ? above : fs::path();
}

}  // namespace

CloudMapFiles cloudMapFiles(const fs::path& path) {
  if (!fs::exists(path)) throw Error(path.string(), "", std::strerror(ENOENT));
  CloudMapFiles result;
  if (!fs::is_directory(path)) {
    result.files.push_back(path);
    return result;
  }
  const fs::path metadata = metadataOf(path);
  const bool tiles_below = !metadata.empty() && fs::is_directory(path / kTileFolder);
  const fs::path folder = tiles_below ? path / kTileFolder : path;
  Names names = cloudsIn(folder);
  if (!metadata.empty()) {
    Names tiles;
    for (const MapTileEntry& tile : readTileMetadata(metadata).tiles) {
      if (!fs::is_regular_file(folder / tile.name)) {
        throw Error((folder / tile.name).string(), "", "is missing, where " + metadata.string() + " names this tile");
      }
      tiles.insert(tile.name);
      names.erase(tile.name);
    }
    result.beside.assign(names.begin(), names.end());
    names = tiles;
  }
  if (names.empty()) throw Error(path.string(), "", "holds no .pcd or .ply file");
  for (const std::string& name : names) result.files.push_back(folder / name);
  return result;
}

}  // namespace saw_ndt::internal
