#include "common/file_buffer.h"

#include <cerrno>

#include "common/write_at.h"

namespace saw_ndt::internal {

namespace {
constexpr std::size_t kBufferBytes = std::size_t{1} << 16U;
}

FileBuffer::FileBuffer(int descriptor) : descriptor_(descriptor), buffer_(kBufferBytes) {
  setp(buffer_.data(), buffer_.data() + buffer_.size());
}

bool FileBuffer::write(const char* bytes, std::size_t count) {
  if (first_error_ == 0 && !writeAt(descriptor_, offset_, bytes, count)) first_error_ = errno != 0 ? errno : EIO;
  offset_ += count;
  return first_error_ == 0;
}

bool FileBuffer::writeBuffered() {
  const bool written = write(pbase(), static_cast<std::size_t>(pptr() - pbase()));
  setp(buffer_.data(), buffer_.data() + buffer_.size());
  return written;
}

FileBuffer::int_type FileBuffer::overflow(int_type c) {
  if (!writeBuffered()) return traits_type::eof();
  if (!traits_type::eq_int_type(c, traits_type::eof())) sputc(traits_type::to_char_type(c));
  return traits_type::not_eof(c);
}

std::streamsize FileBuffer::xsputn(const char* data, std::streamsize size) {
  if (size < epptr() - pptr()) return std::streambuf::xsputn(data, size);
  return writeBuffered() && write(data, static_cast<std::size_t>(size)) ? size : 0;
}

int FileBuffer::sync() { return writeBuffered() ? 0 : -1; }

FileBuffer::pos_type FileBuffer::seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode which) {
  const auto at = static_cast<off_type>(offset_) + (pptr() - pbase());
  if (from == std::ios_base::cur && offset == 0) return at;
  return from == std::ios_base::beg ? seekpos(offset, which) : pos_type(off_type(-1));
}

FileBuffer::pos_type FileBuffer::seekpos(pos_type position, std::ios_base::openmode) {
  if (off_type(position) < 0 || !writeBuffered()) return pos_type(off_type(-1));
  offset_ = static_cast<std::uint64_t>(off_type(position));
  return position;
}

}  // namespace saw_ndt::internal
