#include "saw_ndt/map/map_merge.h"

#include <filesystem>
#include <map>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "map/map_file.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/map/weighted_map_builder.h"

namespace saw_ndt {
namespace {

void requireDifferentFiles(const std::vector<std::string>& paths) {
  std::map<std::filesystem::path, std::string> met;
  for (const std::string& path : paths) {
    std::error_code error;
    const std::filesystem::path canonical = std::filesystem::canonical(path, error);
    if (error) throw Error(path, "", error.message());
    const auto [other, is_new] = met.emplace(canonical, path);
    if (!is_new) {
      throw Error(path, "",
                  "is given twice" + (other->second == path ? "" : ", also as " + other->second) +
                      ": its scans would count twice");
    }
  }
}

void merge(const WeightedVoxelMap& map, const std::string& path, const std::string& first, WeightedMapBuilder& into) {
  try {
    into.merge(map);
  } catch (const std::invalid_argument& error) {
    throw Error(path, "", "does not merge with " + first + ": " + error.what());
  }
}

}  // namespace

WeightedVoxelMap mergeMapFiles(const std::vector<std::string>& paths) {
  if (paths.empty()) throw std::invalid_argument("paths: no map to merge");
  requireDifferentFiles(paths);
  std::vector<MapOrigin> origins;
  for (const std::string& path : paths) origins.push_back(internal::MapFileReader(path).origin());
  WeightedMapBuilder builder(origins.front().resolution_m, origins.front().segmentation);
  // What differs is found out before the long work.
  WeightedMapBuilder trial = builder;
  for (std::size_t i = 0; i < paths.size(); ++i) merge({origins[i], {}}, paths[i], paths.front(), trial);
  for (const std::string& path : paths) merge(WeightedVoxelMap::load(path), path, paths.front(), builder);
  return std::move(builder).build();
}

}  // namespace saw_ndt
