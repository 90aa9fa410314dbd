#include "io/tile_metadata.h"

#include "saw_ndt/common/error.h"

#if SAW_NDT_HAS_YAML

#include <yaml-cpp/yaml.h>

#include <cmath>
#include <set>

#include "common/input_file.h"
#include "io/number_lines.h"

namespace saw_ndt::internal {

namespace {

class MetadataReader {
 public:
  explicit MetadataReader(const std::filesystem::path& path) : path_(path) {}

  TileMetadata read() {
    TileMetadata metadata;
    std::ifstream stream = openInputFile(path_);
    try {
      const YAML::Node root = YAML::Load(stream);
      if (!root.IsMap()) refuse(root, "the metadata are no map of names and values");
      std::set<std::string> keys;
      for (const auto& member : root) {
        const std::string key = textOf(member.first);
        if (!keys.insert(key).second) refuse(member.first, key + " is given twice");
        if (key == "x_resolution") {
          metadata.x_resolution_m = edgeOf(member.second, key);
        } else if (key == "y_resolution") {
          metadata.y_resolution_m = edgeOf(member.second, key);
        } else {
          metadata.tiles.push_back({tileName(member.first, key), cornerOf(member.second, key)});
        }
      }
      for (const char* key : {"x_resolution", "y_resolution"}) {
        if (keys.count(key) == 0) throw Error(path_.string(), "", std::string("gives no ") + key);
      }
    } catch (const YAML::Exception& error) {
      refuseAt(error.mark, error.msg);
    }
    if (metadata.tiles.empty()) throw Error(path_.string(), "", "names no tile");
    return metadata;
  }

 private:
  [[noreturn]] void refuseAt(const YAML::Mark& mark, const std::string& reason) const {
    throw Error(path_.string(), mark.is_null() ? "" : linePlace(static_cast<std::size_t>(mark.line) + 1), reason);
  }
  [[noreturn]] void refuse(const YAML::Node& node, const std::string& reason) const { refuseAt(node.Mark(), reason); }

  std::string textOf(const YAML::Node& node) const {
    if (!node.IsScalar()) refuse(node, "a name is needed");
    return node.Scalar();
  }

  double numberOf(const YAML::Node& node, const std::string& key) const {
    double number = 0.0;
    if (!YAML::convert<double>::decode(node, number) || !std::isfinite(number)) {
      refuse(node, key + " has what is no number");
    }
    return number;
  }

  double edgeOf(const YAML::Node& node, const std::string& key) const {
    const double edge_m = numberOf(node, key);
    if (edge_m <= 0.0) refuse(node, key + " must be positive");
    return edge_m;
  }

  std::string tileName(const YAML::Node& node, const std::string& name) const {
    const std::filesystem::path file(name);
    if (file.has_parent_path() || file.extension() != ".pcd") {
      refuse(node, "'" + name.substr(0, 80) + "' is no name of a PCD file beside the metadata");
    }
    return name;
  }

  std::array<double, 2> cornerOf(const YAML::Node& node, const std::string& name) const {
    if (!node.IsSequence() || node.size() != 2) refuse(node, name + " needs the x and y of the tile's corner");
    return {numberOf(node[0], name), numberOf(node[1], name)};
  }

  std::filesystem::path path_;
};

}  // namespace

TileMetadata readTileMetadata(const std::filesystem::path& path) { return MetadataReader(path).read(); }

}  // namespace saw_ndt::internal

#else

namespace saw_ndt::internal {

TileMetadata readTileMetadata(const std::filesystem::path& path) {
  throw Error(path.string(), "", "cannot be read, since saw_ndt was built without libyaml-cpp-dev");
}

}  // namespace saw_ndt::internal

#endif
