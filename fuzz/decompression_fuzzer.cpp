// Compressed data; the first byte chooses how they were compressed.
#include <algorithm>

#include "fuzzed_file.h"
#include "io/decompression.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace saw_ndt::internal;
  constexpr std::uint64_t kGreatest = 1 << 20;
  if (size == 0) return 0;
  const ByteView compressed{data + 1, size - 1};
  std::vector<unsigned char> bytes;
  try {
    switch (data[0] % 3) {
      case 0:
        decompressLz4(compressed, kGreatest, bytes);
        break;
      case 1:
        decompressZstd(compressed, kGreatest, bytes);
        break;
      default:
        decompressBz2(compressed, kGreatest, bytes);
    }
  } catch (const DamagedData&) {
  }
  saw_ndt::require(bytes.size() <= kGreatest, "no more is unpacked than is asked for");
  return 0;
}
