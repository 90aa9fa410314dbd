#include "io/random_access_file.h"

#include <algorithm>

#include "common/input_file.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

namespace {

constexpr std::uint64_t kWindowBytes = 16384;

}  // namespace

RandomAccessFile::RandomAccessFile(const std::filesystem::path& path) : path_(path), stream_(openInputFile(path)) {
  stream_.seekg(0, std::ios::end);
  const std::streamoff end = stream_.tellg();
  if (end < 0) throw Error(path.string(), "", "its size cannot be told");
  size_ = static_cast<std::uint64_t>(end);
}

ByteView RandomAccessFile::read(std::uint64_t offset, std::uint64_t size) {
  if (offset > size_ || size > size_ - offset) {
    throw Error(path_.string(), "offset " + std::to_string(offset),
                "the file ends before the " + std::to_string(size) + " bytes that should be here");
  }
  if (size > kWindowBytes / 2) {
    fill(large_, offset, size);
    return {large_.data(), large_.size()};
  }
  if (offset < window_offset_ || offset + size > window_offset_ + window_.size()) {
    fill(window_, offset, std::min(kWindowBytes, size_ - offset));
    window_offset_ = offset;
  }
  return {window_.data() + (offset - window_offset_), static_cast<std::size_t>(size)};
}

void RandomAccessFile::fill(std::vector<unsigned char>& bytes, std::uint64_t offset, std::uint64_t size) {
  bytes.resize(size);
  stream_.clear();
  stream_.seekg(static_cast<std::streamoff>(offset));
  stream_.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (!stream_) {
    bytes.clear();
    throw Error(path_.string(), "offset " + std::to_string(offset), "could not be read on");
  }
}

}  // namespace saw_ndt::internal
