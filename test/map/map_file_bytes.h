#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>

namespace saw_ndt {

// The bytes of map files, written out apart from the code that is tested.

constexpr std::size_t kHeaderBytes = 96;
constexpr std::size_t kTileBytes = 40;
constexpr std::size_t kEntryBytes = 84;

/// CRC-32 as zlib and PNG define it, written out bit by bit.
inline std::uint32_t crc32(const std::string& bytes) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const char byte : bytes) {
    crc ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1U) != 0U ? 0xEDB88320U : 0U);
  }
  return ~crc;
}

template <typename Value>
std::string littleEndian(Value value) {
  std::uint64_t bits = 0;
  static_assert(sizeof(Value) <= sizeof(bits));
  std::memcpy(&bits, &value, sizeof(value));
  std::string bytes;
  for (std::size_t i = 0; i < sizeof(Value); ++i) bytes += static_cast<char>(bits >> (8 * i));
  return bytes;
}

template <typename Value>
void put(std::string& bytes, std::size_t offset, Value value) {
  bytes.replace(offset, sizeof(Value), littleEndian(value));
}

template <typename Value>
Value valueAt(const std::string& bytes, std::size_t offset) {
  Value value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

/// Where the directory of a file lies.
inline std::size_t directoryOf(const std::string& bytes) {
  return kHeaderBytes + (valueAt<std::uint32_t>(bytes, 8) == 1 ? 0 : valueAt<std::uint32_t>(bytes, 68));
}

/// Makes the checksums of the directory, the metadata and the header agree with what the bytes have become.
inline void checksumFront(std::string& bytes) {
  const std::size_t directory = directoryOf(bytes);
  put(bytes, 64, crc32(bytes.substr(directory, kTileBytes)));
  if (valueAt<std::uint32_t>(bytes, 8) != 1) {
    put(bytes, 72, crc32(bytes.substr(kHeaderBytes, directory - kHeaderBytes)));
  }
  put(bytes, 92, crc32(bytes.substr(0, 92)));
}

/// The same for all of a file of one tile.
inline void checksum(std::string& bytes) {
  const std::size_t directory = directoryOf(bytes);
  put(bytes, directory + 12, crc32(bytes.substr(directory + kTileBytes)));
  checksumFront(bytes);
}

/// What version 2 of the format would have made of a file: the same without counts of scans.
inline std::string asVersion2(std::string bytes) {
  put(bytes, 8, std::uint32_t{2});
  const auto tiles = valueAt<std::uint64_t>(bytes, 56);
  const std::size_t directory = directoryOf(bytes);
  for (std::size_t tile = 0; tile < tiles; ++tile) {
    const std::size_t record = directory + tile * kTileBytes;
    const auto count = valueAt<std::uint64_t>(bytes, record + 16);
    const auto offset = valueAt<std::uint64_t>(bytes, record + 24);
    for (std::size_t entry = 0; entry < count; ++entry) {
      bytes.replace(offset + entry * kEntryBytes + 9, 3, std::string(3, '\0'));
    }
    put(bytes, record + 12, crc32(bytes.substr(offset, count * kEntryBytes)));
  }
  put(bytes, 64, crc32(bytes.substr(directory, tiles * kTileBytes)));
  put(bytes, 92, crc32(bytes.substr(0, 92)));
  return bytes;
}

/// What version 1 would have made of it: without metadata, too.
inline std::string asVersion1(std::string bytes) {
  bytes = asVersion2(std::move(bytes));
  const std::size_t metadata = directoryOf(bytes) - kHeaderBytes;
  bytes.erase(kHeaderBytes, metadata);
  put(bytes, 8, std::uint32_t{1});
  put(bytes, 68, std::uint64_t{0});
  const auto tiles = valueAt<std::uint64_t>(bytes, 56);
  for (std::size_t tile = 0; tile < tiles; ++tile) {
    const std::size_t offset = kHeaderBytes + tile * kTileBytes + 24;
    put(bytes, offset, valueAt<std::uint64_t>(bytes, offset) - metadata);
  }
  put(bytes, 64, crc32(bytes.substr(kHeaderBytes, tiles * kTileBytes)));
  put(bytes, 92, crc32(bytes.substr(0, 92)));
  return bytes;
}

}  // namespace saw_ndt
