#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "io/byte_reader.h"

namespace saw_ndt::internal {

/// What no chunk and no message is larger than, so that a small file cannot ask for all of the memory.
constexpr std::uint64_t kGreatestUnpackedBytes = std::uint64_t{1} << 30;

/// What one step of a decompression did.
struct DecompressionStep {
  std::size_t written = 0;
  bool ended = false;  ///< the compressed data are complete
  bool stuck = false;  ///< they end too early
};

/// Collects what step(to, room) writes, which throws DamagedData; memory grows with what is really there, and what
/// was written before is left in `bytes`.
/// @param compressed_bytes  how large the compressed data are
/// @param greatest          no more is written
template <typename Step>
void collectDecompressed(std::size_t compressed_bytes, std::uint64_t greatest, std::vector<unsigned char>& bytes,
                         Step step) {
  constexpr std::size_t kFewBytes = 65536, kUsualRatio = 4;
  const auto limit = static_cast<std::size_t>(greatest);
  bytes.resize(std::min(limit, std::max(kFewBytes, kUsualRatio * compressed_bytes)));
  std::size_t size = 0;
  try {
    while (size < limit) {
      if (size == bytes.size()) bytes.resize(std::min(limit, 2 * bytes.size()));
      const DecompressionStep done = step(bytes.data() + size, bytes.size() - size);
      size += done.written;
      if (done.ended) break;
      if (done.stuck) throw DamagedData("the compressed data end too early");
    }
  } catch (const DamagedData&) {
    bytes.resize(size);
    throw;
  }
  bytes.resize(size);
}

/// These unpack an LZ4 frame, a Zstandard frame and a bzip2 stream; throw DamagedData.
/// @param greatest  bytes at most, what follows is left out
void decompressLz4(ByteView compressed, std::uint64_t greatest, std::vector<unsigned char>& bytes);
void decompressZstd(ByteView compressed, std::uint64_t greatest, std::vector<unsigned char>& bytes);
void decompressBz2(ByteView compressed, std::uint64_t greatest, std::vector<unsigned char>& bytes);

/// Throws DamagedData unless that many bytes may be unpacked.
inline void requireUnpackedSize(std::uint64_t size) {
  if (size > kGreatestUnpackedBytes) {
    throw DamagedData("it should have " + std::to_string(size) + " bytes, more than any chunk has");
  }
}

/// Throws DamagedData unless as many bytes were unpacked as were stated.
inline void requireAllUnpacked(std::size_t unpacked, std::uint64_t stated) {
  if (unpacked != stated) {
    throw DamagedData("it unpacks to " + std::to_string(unpacked) + " bytes instead of " + std::to_string(stated));
  }
}

}  // namespace saw_ndt::internal
