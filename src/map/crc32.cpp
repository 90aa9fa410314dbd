#include "map/crc32.h"

#include <array>

namespace saw_ndt {
namespace {

constexpr std::size_t kStride = 8;
using Tables = std::array<std::array<std::uint32_t, 256>, kStride>;

// Table k holds what a byte adds to the remainder once k more bytes have followed it: eight bytes then take eight
// look-ups that do not wait for each other.
constexpr Tables makeTables() {
  Tables tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t remainder = byte;
    for (int bit = 0; bit < 8; ++bit) remainder = (remainder >> 1) ^ ((remainder & 1U) != 0U ? 0xEDB88320U : 0U);
    tables[0][byte] = remainder;
  }
  for (std::size_t k = 1; k < kStride; ++k) {
    for (std::size_t byte = 0; byte < 256; ++byte) {
      const std::uint32_t before = tables[k - 1][byte];
      tables[k][byte] = (before >> 8) ^ tables[0][before & 0xFFU];
    }
  }
  return tables;
}

constexpr Tables kTables = makeTables();

}  // namespace

std::uint32_t crc32(const char* bytes, std::size_t size) {
  const auto* at = reinterpret_cast<const unsigned char*>(bytes);
  const auto* const end = at + size;
  std::uint32_t remainder = 0xFFFFFFFFU;
  for (; static_cast<std::size_t>(end - at) >= kStride; at += kStride) {
    const std::uint32_t first =
        remainder ^ (static_cast<std::uint32_t>(at[0]) | static_cast<std::uint32_t>(at[1]) << 8 |
                     static_cast<std::uint32_t>(at[2]) << 16 | static_cast<std::uint32_t>(at[3]) << 24);
    remainder = kTables[7][first & 0xFFU] ^ kTables[6][(first >> 8) & 0xFFU] ^ kTables[5][(first >> 16) & 0xFFU] ^
                kTables[4][first >> 24] ^ kTables[3][at[4]] ^ kTables[2][at[5]] ^ kTables[1][at[6]] ^ kTables[0][at[7]];
  }
  for (; at != end; ++at) remainder = (remainder >> 8) ^ kTables[0][(remainder ^ *at) & 0xFFU];
  return ~remainder;
}

}  // namespace saw_ndt
