// Scans of floats without a header, of 4, 5, 6 or an unknown number of columns, which the first byte chooses.
#include "fuzzed_scan_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static saw_ndt::FuzzedFile file("scan.bin");
  if (size == 0) return 0;
  constexpr int kColumns[] = {0, 4, 5, 6};
  file.tryReading(data + 1, size - 1, [&](const std::filesystem::path& path) {
    saw_ndt::requireConsistent(saw_ndt::readScanPoints(path, kColumns[data[0] % 4]));
  });
  return 0;
}
