#include "fuzzed_file.h"
#include "simulation/scene_description.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static saw_ndt::FuzzedFile file("scene.json");
  file.tryReading(data, size, [](const std::filesystem::path& path) { saw_ndt::readSceneDescription(path).check(); });
  return 0;
}
