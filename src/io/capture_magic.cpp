#include "io/capture_magic.h"

#include <algorithm>
#include <array>
#include <fstream>

namespace saw_ndt::internal {

bool isCapture(const std::filesystem::path& path) {
  using Magic = std::array<unsigned char, 4>;
  constexpr std::array<Magic, 5> kMagics = {{{0xD4, 0xC3, 0xB2, 0xA1},
                                             {0xA1, 0xB2, 0xC3, 0xD4},
                                             {0x4D, 0x3C, 0xB2, 0xA1},
                                             {0xA1, 0xB2, 0x3C, 0x4D},
                                             {0x0A, 0x0D, 0x0D, 0x0A}}};
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return false;
  std::ifstream stream(path, std::ios::binary);
  Magic magic{};
  if (!stream.read(reinterpret_cast<char*>(magic.data()), magic.size())) return false;
  return std::find(kMagics.begin(), kMagics.end(), magic) != kMagics.end();
}

}  // namespace saw_ndt::internal
