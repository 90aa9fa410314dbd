#include "fuzzed_file.h"
#include "io/tile_metadata.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static saw_ndt::FuzzedFile file("pointcloud_map_metadata.yaml");
  file.tryReading(data, size, [](const std::filesystem::path& path) {
    for (const saw_ndt::internal::MapTileEntry& tile : saw_ndt::internal::readTileMetadata(path).tiles) {
      saw_ndt::require(!tile.name.empty() && tile.name.find('/') == std::string::npos,
                       "tiles lie beside their metadata");
    }
  });
  return 0;
}
