#include <lz4frame.h>

#include <memory>
#include <new>

#include "io/decompression.h"

namespace saw_ndt::internal {

void decompressLz4(ByteView compressed, std::uint64_t greatest, std::vector<unsigned char>& bytes) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION))) throw std::bad_alloc();
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> owner(context,
                                                                                   &LZ4F_freeDecompressionContext);
  std::size_t position = 0;
  collectDecompressed(compressed.size, greatest, bytes, [&](unsigned char* to, std::size_t room) {
    std::size_t taken = compressed.size - position, written = room;
    const std::size_t hint = LZ4F_decompress(context, to, &written, compressed.data + position, &taken, nullptr);
    if (LZ4F_isError(hint)) {
      throw DamagedData(std::string("the LZ4 data are damaged (") + LZ4F_getErrorName(hint) + ")");
    }
    position += taken;
    return DecompressionStep{written, hint == 0, taken == 0 && written == 0};
  });
}

}  // namespace saw_ndt::internal
