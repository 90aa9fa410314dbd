#include "common/atomic_output.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <functional>
#include <locale>
#include <optional>
#include <sstream>
#include <string>
#include <system_error>

#include "common/claimed_name.h"
#include "common/file_buffer.h"
#include "common/owner_and_mode.h"
#include "common/unfinished_output.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

namespace fs = std::filesystem;

namespace {

/// What the name of a temporary file begins with: that of the target, as far as there is room for it.
fs::path stemOf(const fs::path& target) {
  constexpr std::size_t kMostBytes = 200;
  std::string name = target.filename().string();
  if (name.size() > kMostBytes) {
    std::ostringstream cut;
    std::size_t end = kMostBytes;
    while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0U) == 0x80U) --end;  // not within a character
    cut << name.substr(0, end) << '~' << std::hex << std::hash<std::string>()(name);
    name = cut.str();
  }
  return target.parent_path() / (name + ".tmp");
}

/// What is under a name; nothing where that is free. Throws Error where a file of that name cannot be.
std::optional<struct stat> existing(const fs::path& resolved, const fs::path& target) {
  struct stat status {};
  if (stat(resolved.c_str(), &status) == 0) {
    if (S_ISDIR(status.st_mode)) throw Error(target.string(), "", std::strerror(EISDIR));
    if (!S_ISREG(status.st_mode)) throw Error(target.string(), "", "is no regular file");
    return status;
  }
  if (errno != ENOENT || !resolved.has_filename()) throw Error(target.string(), "", std::strerror(errno));
  return std::nullopt;
}

}  // namespace

class AtomicOutput::Temporary {
 public:
  Temporary(const fs::path& target, const std::optional<struct stat>& replaced)
      : output_([&] {
          // Nobody is to see what will be in it who does not see the one that it replaces.
          claimed_.emplace(ClaimedName::ofFile(stemOf(target), replaced ? 0600 : 0666));
          return claimed_->path();
        }),
        buffer_(claimed_->descriptor()) {
    if (replaced) giveOwnerAndMode(*replaced, claimed_->descriptor());
  }

  const fs::path& path() const { return output_.path(); }
  FileBuffer& buffer() { return buffer_; }

  /// The errno of what has failed; 0: all that was written is there.
  int failure(bool to_the_disk) const {
    if (buffer_.firstError() != 0) return buffer_.firstError();
    // Some file systems tell failures no sooner than a file is closed, which would leave it without a lock.
    const int copy = dup(claimed_->descriptor());
    if (copy < 0 || close(copy) != 0) return errno;
    return to_the_disk && fsync(claimed_->descriptor()) != 0 ? errno : 0;
  }

  void rename(const fs::path& target) {
    output_.finish([&] { fs::rename(path(), target); });
    claimed_.reset();
  }

 private:
  std::optional<ClaimedName> claimed_;  // locked until it is renamed or removed
  UnfinishedOutput output_;
  FileBuffer buffer_;
};

AtomicOutput::AtomicOutput(const fs::path& target) : target_(target), resolved_target_(target), stream_(nullptr) {
  std::error_code error;
  if (fs::is_symlink(target, error)) {
    resolved_target_ = fs::weakly_canonical(target, error);
    if (error) throw Error(target.string(), "", error.message());
  }
  const std::optional<struct stat> replaced = existing(resolved_target_, target);
  try {
    temporary_ = std::make_unique<Temporary>(resolved_target_, replaced);
  } catch (const std::system_error& failure) {
    throw Error(target.string(), "", failure.code().message());
  }
  stream_.rdbuf(&temporary_->buffer());
  stream_.imbue(std::locale::classic());
}

AtomicOutput::~AtomicOutput() = default;

std::ostream& AtomicOutput::stream() { return stream_; }

const fs::path& AtomicOutput::temporary() const { return temporary_->path(); }

void AtomicOutput::commit() {
  stream_.flush();
  if (const int failure = temporary_->failure(existing(resolved_target_, target_).has_value())) {
    throw Error(target_.string(), "", std::strerror(failure));
  }
  if (!stream_) throw Error(target_.string(), "", "could not be written");
  try {
    temporary_->rename(resolved_target_);
  } catch (const std::system_error& failure) {
    throw Error(target_.string(), "", failure.code().message());
  }
}

}  // namespace saw_ndt::internal
