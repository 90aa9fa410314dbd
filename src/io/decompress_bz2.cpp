#include <bzlib.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <new>

#include "io/decompression.h"

namespace saw_ndt::internal {

void decompressBz2(ByteView compressed, std::uint64_t greatest, std::vector<unsigned char>& bytes) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) throw std::bad_alloc();
  const std::unique_ptr<bz_stream, decltype(&BZ2_bzDecompressEnd)> owner(&stream, &BZ2_bzDecompressEnd);
  constexpr std::size_t kGreatestPart = std::numeric_limits<unsigned int>::max();
  // bzlib does not write to what it reads; its interface is older than const.
  stream.next_in = const_cast<char*>(reinterpret_cast<const char*>(compressed.data));
  stream.avail_in = static_cast<unsigned int>(std::min(compressed.size, kGreatestPart));
  collectDecompressed(compressed.size, greatest, bytes, [&](unsigned char* to, std::size_t room) {
    const auto part = static_cast<unsigned int>(std::min(room, kGreatestPart));
    const unsigned int before = stream.avail_in;
    stream.next_out = reinterpret_cast<char*>(to);
    stream.avail_out = part;
    const int result = BZ2_bzDecompress(&stream);
    if (result != BZ_OK && result != BZ_STREAM_END) throw DamagedData("the bzip2 data are damaged");
    const std::size_t written = part - stream.avail_out;
    return DecompressionStep{written, result == BZ_STREAM_END, written == 0 && stream.avail_in == before};
  });
}

}  // namespace saw_ndt::internal
