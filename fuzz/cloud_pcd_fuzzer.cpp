#include "fuzzed_cloud_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static saw_ndt::FuzzedFile file("scan.pcd");
  saw_ndt::tryReadingCloud(file, data, size);
  return 0;
}
