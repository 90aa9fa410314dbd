#pragma once

#include <cstdint>
#include <streambuf>
#include <vector>

namespace saw_ndt::internal {

/// Writes to an open file, which it does not close. It keeps the errno of the first write that failed: by the time that
/// somebody asks, others may have replaced it.
class FileBuffer : public std::streambuf {
 public:
  explicit FileBuffer(int descriptor);

  int firstError() const { return first_error_; }

 protected:
  int_type overflow(int_type c) override;
  std::streamsize xsputn(const char* data, std::streamsize size) override;
  int sync() override;
  pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode which) override;
  pos_type seekpos(pos_type position, std::ios_base::openmode which) override;

 private:
  bool write(const char* bytes, std::size_t count);
  bool writeBuffered();

  int descriptor_;
  std::uint64_t offset_ = 0;  // of what is buffered
  std::vector<char> buffer_;
  int first_error_ = 0;
};

}  // namespace saw_ndt::internal
