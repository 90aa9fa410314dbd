#include "common/atomic_output.h"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <locale>
#include <string>

#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

namespace fs = std::filesystem;

/// Keeps the errno of the first write that failed: by the time of commit() others may have replaced it.
class AtomicOutput::FileBuffer : public std::filebuf {
 public:
  int firstError() const { return first_error_; }
  void noteError() {
    if (first_error_ == 0) first_error_ = errno != 0 ? errno : EIO;
  }

 protected:
  int_type overflow(int_type c) override {
    errno = 0;
    const int_type result = std::filebuf::overflow(c);
    if (traits_type::eq_int_type(result, traits_type::eof())) noteError();
    return result;
  }
  std::streamsize xsputn(const char* data, std::streamsize size) override {
    errno = 0;
    const std::streamsize written = std::filebuf::xsputn(data, size);
    if (written != size) noteError();
    return written;
  }
  int sync() override {
    errno = 0;
    const int result = std::filebuf::sync();
    if (result != 0) noteError();
    return result;
  }

 private:
  int first_error_ = 0;
};

AtomicOutput::AtomicOutput(const fs::path& target)
    : target_(target), resolved_target_(target), buffer_(std::make_unique<FileBuffer>()), stream_(nullptr) {
  std::error_code ignored;
  if (fs::is_symlink(target, ignored)) resolved_target_ = fs::weakly_canonical(target, ignored);
  if (fs::is_directory(resolved_target_, ignored)) throw Error(target.string(), "", std::strerror(EISDIR));
  if (fs::exists(resolved_target_, ignored) && !fs::is_regular_file(resolved_target_, ignored)) {
    throw Error(target.string(), "", "is no regular file");
  }

  static std::atomic<unsigned> counter{0};
  temporary_ = resolved_target_;
  temporary_ += ".tmp-" + std::to_string(getpid()) + "-" + std::to_string(counter++);
  buffer_->pubimbue(std::locale::classic());
  errno = 0;
  if (buffer_->open(temporary_, std::ios::out | std::ios::binary | std::ios::trunc) == nullptr) {
    throw Error(target.string(), "", errno != 0 ? std::strerror(errno) : "cannot be opened for writing");
  }
  stream_.rdbuf(buffer_.get());
  stream_.imbue(std::locale::classic());
}

AtomicOutput::~AtomicOutput() {
  buffer_->close();
  if (temporary_.empty()) return;
  std::error_code ignored;
  fs::remove(temporary_, ignored);
}

std::ostream& AtomicOutput::stream() { return stream_; }

void AtomicOutput::commit() {
  stream_.flush();
  errno = 0;
  if (buffer_->close() == nullptr) buffer_->noteError();
  if (buffer_->firstError() != 0) throw Error(target_.string(), "", std::strerror(buffer_->firstError()));
  if (!stream_) throw Error(target_.string(), "", "could not be written");
  std::error_code failure;
  fs::rename(temporary_, resolved_target_, failure);
  if (failure) throw Error(target_.string(), "", failure.message());
  temporary_.clear();
}

}  // namespace saw_ndt::internal
