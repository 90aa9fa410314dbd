#include <zstd.h>

#include <memory>
#include <new>

#include "io/decompression.h"

namespace saw_ndt::internal {

void decompressZstd(ByteView compressed, std::uint64_t greatest, std::vector<unsigned char>& bytes) {
  const std::unique_ptr<ZSTD_DStream, decltype(&ZSTD_freeDStream)> stream(ZSTD_createDStream(), &ZSTD_freeDStream);
  if (stream == nullptr) throw std::bad_alloc();
  ZSTD_inBuffer in{compressed.data, compressed.size, 0};
  collectDecompressed(compressed.size, greatest, bytes, [&](unsigned char* to, std::size_t room) {
    ZSTD_outBuffer out{to, room, 0};
    const std::size_t before = in.pos;
    const std::size_t left = ZSTD_decompressStream(stream.get(), &out, &in);
    if (ZSTD_isError(left)) {
      throw DamagedData(std::string("the Zstandard data are damaged (") + ZSTD_getErrorName(left) + ")");
    }
    return DecompressionStep{out.pos, left == 0, out.pos == 0 && in.pos == before};
  });
}

}  // namespace saw_ndt::internal
