#include "common/printable.h"

#include <algorithm>

namespace saw_ndt::internal {
namespace {

bool isControl(unsigned char byte) { return (byte < 0x20 && byte != '\n') || byte == 0x7f; }

// U+0080 to U+009F, which are control characters too, in UTF-8.
bool isHighControl(unsigned char first, unsigned char second) {
  return first == 0xc2 && second >= 0x80 && second < 0xa0;
}

}  // namespace

std::string printable(const std::string& text) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string result;
  const auto escape = [&](unsigned char byte) { result += {'\\', 'x', kDigits[byte >> 4], kDigits[byte & 15]}; };
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const auto next = static_cast<unsigned char>(i + 1 < text.size() ? text[i + 1] : '\0');
    if (isHighControl(byte, next)) {
      escape(byte);
      escape(next);
      ++i;
    } else if (isControl(byte)) {
      escape(byte);
    } else {
      result += text[i];
    }
  }
  return result;
}

std::string printableLine(const std::string& text) {
  std::string line = text;
  std::replace(line.begin(), line.end(), '\n', ' ');
  return printable(line);
}

}  // namespace saw_ndt::internal
