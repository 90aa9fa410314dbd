#include "fuzzed_file.h"
#include "saw_ndt/io/polygon_file.h"
#include "saw_ndt/map/map_region.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static saw_ndt::FuzzedFile file("polygon.csv");
  file.tryReading(data, size, [](const std::filesystem::path& path) {
    const saw_ndt::MapRegion region = saw_ndt::polygonRegion(saw_ndt::readPolygon(path));
    const Eigen::AlignedBox3d box(Eigen::Vector3d(-1, -1, -1), Eigen::Vector3d(1, 1, 1));
    saw_ndt::require(region.mayMeet(box) || !region(Eigen::Vector3d::Zero()), "boxes agree with positions");
  });
  return 0;
}
