#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>

namespace saw_ndt::internal {

/// Bytes somewhere in memory, not owned.
struct ByteView {
  const unsigned char* data = nullptr;
  std::size_t size = 0;
};

/// Data are not what they should be. what() is the reason, as a clause; who knows the file makes an Error of it.
class DamagedData : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reads little-endian numbers and strings one after the other. Throws DamagedData instead of reading past the end.
class ByteReader {
 public:
  explicit ByteReader(ByteView bytes) : bytes_(bytes) {}

  std::size_t remaining() const { return bytes_.size - position_; }
  std::size_t position() const { return position_; }

  template <typename Number>
  Number read() {
    Number number;
    std::memcpy(&number, bytes(sizeof(Number)).data, sizeof(Number));
    return number;
  }

  ByteView bytes(std::uint64_t size) {
    if (size > remaining()) {
      throw DamagedData(std::to_string(size) + " bytes should follow where " + std::to_string(remaining()) +
                        " are left");
    }
    const ByteView view{bytes_.data + position_, static_cast<std::size_t>(size)};
    position_ += view.size;
    return view;
  }

  /// A string that a uint32 tells the length of.
  std::string readString() {
    const ByteView text = bytes(read<std::uint32_t>());
    return std::string(reinterpret_cast<const char*>(text.data), text.size);
  }

 private:
  ByteView bytes_;
  std::size_t position_ = 0;
};

}  // namespace saw_ndt::internal
