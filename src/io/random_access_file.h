#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <vector>

#include "io/byte_reader.h"

namespace saw_ndt::internal {

/// A file that is read here and there. Small reads close to each other cost one access.
class RandomAccessFile {
 public:
  /// Throws Error where it cannot be opened.
  explicit RandomAccessFile(const std::filesystem::path& path);

  const std::filesystem::path& path() const { return path_; }
  std::uint64_t size() const { return size_; }

  /// Bytes of the file; they stay until the next call. Throws Error where the file ends before them.
  ByteView read(std::uint64_t offset, std::uint64_t size);

 private:
  void fill(std::vector<unsigned char>& bytes, std::uint64_t offset, std::uint64_t size);

  std::filesystem::path path_;
  std::ifstream stream_;
  std::uint64_t size_ = 0;
  std::uint64_t window_offset_ = 0;
  std::vector<unsigned char> window_;  // of the file, from window_offset_
  std::vector<unsigned char> large_;
};

/// The bytes of a chunk of a file, unpacked, of the chunk that was asked for last.
class ChunkCache {
 public:
  /// @param place   tells the chunk
  /// @param unpack  unpack(bytes) gives the bytes and throws DamagedData; not called for a chunk twice in a row, also
  ///                not where it failed
  template <typename Unpack>
  ByteView get(std::uint64_t place, Unpack unpack) {
    if (!known_ || place != place_) {
      known_ = true;
      place_ = place;
      failure_.clear();
      try {
        unpack(bytes_);
      } catch (const DamagedData& damage) {
        failure_ = damage.what();
      }
    }
    if (!failure_.empty()) throw DamagedData(failure_);
    return {bytes_.data(), bytes_.size()};
  }

 private:
  bool known_ = false;
  std::uint64_t place_ = 0;
  std::string failure_;
  std::vector<unsigned char> bytes_;
};

}  // namespace saw_ndt::internal
