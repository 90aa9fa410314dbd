#pragma once

#include <cstddef>
#include <cstdint>

namespace saw_ndt {

/// The CRC-32 of zlib and PNG.
std::uint32_t crc32(const char* bytes, std::size_t size);

}  // namespace saw_ndt
