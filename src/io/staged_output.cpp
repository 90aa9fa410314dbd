#include "io/staged_output.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <optional>
#include <string>
#include <system_error>

#include "common/claimed_name.h"
#include "common/owner_and_mode.h"
#include "common/unfinished_output.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const fs::path& path, int error) { throw Error(path.string(), "", std::strerror(error)); }

/// Throws Error where something in a folder cannot go to the same place in another one.
void requireRoom(const fs::path& from, const fs::path& to) {
  for (const fs::directory_entry& entry : fs::directory_iterator(from)) {
    const fs::path there = to / entry.path().filename();
    std::error_code ignored;
    const fs::file_status status = fs::status(there, ignored);
    if (!entry.is_directory() && fs::is_directory(status)) throw Error(there.string(), "", "is a folder");
    if (!entry.is_directory() || !fs::exists(status)) continue;
    if (!fs::is_directory(status)) fail(there, ENOTDIR);
    requireRoom(entry.path(), there);
  }
}

/// A file that will be replaced is lost no sooner than the new one is on the disk.
void prepareToReplace(const fs::path& old_file, const fs::path& new_file) {
  struct stat replaced {};
  if (stat(old_file.c_str(), &replaced) != 0) return;
  const int descriptor = open(new_file.c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor < 0) fail(old_file, errno);
  giveOwnerAndMode(replaced, descriptor);
  const int error = fsync(descriptor) != 0 ? errno : 0;
  close(descriptor);
  if (error != 0) fail(old_file, error);
}

void prepareToReplaceFiles(const fs::path& from, const fs::path& to) {
  for (const fs::directory_entry& entry : fs::directory_iterator(from)) {
    const fs::path there = to / entry.path().filename();
    entry.is_directory() ? prepareToReplaceFiles(entry.path(), there) : prepareToReplace(there, entry.path());
  }
}

void move(const fs::path& from, const fs::path& to) {
  for (const fs::directory_entry& entry : fs::directory_iterator(from)) {
    const fs::path there = to / entry.path().filename();
    std::error_code error;
    if (entry.is_directory() && fs::is_directory(there, error)) {
      move(entry.path(), there);
    } else {
      fs::rename(entry.path(), there, error);
      if (error) throw Error(there.string(), "", error.message());
    }
  }
}

}  // namespace

class StagedOutput::Staging {
 public:
  explicit Staging(const fs::path& target)
      : output_([&] {
          claimed_.emplace(ClaimedName::ofFolder(target / ".saw_ndt"));
          return claimed_->path();
        }) {}

  const fs::path& folder() const { return output_.path(); }

  void moveTo(const fs::path& target) {
    requireRoom(folder(), target);
    prepareToReplaceFiles(folder(), target);
    output_.finish([&] {
      move(folder(), target);
      std::error_code ignored;
      fs::remove_all(folder(), ignored);
    });
  }

 private:
  std::optional<ClaimedName> claimed_;  // locked until it is removed
  UnfinishedOutput output_;
};

StagedOutput::StagedOutput(const fs::path& target) : target_(target) {
  try {
    staging_ = std::make_unique<Staging>(target);
  } catch (const std::system_error& failure) {
    throw Error(target.string(), "", failure.code().message());
  }
}

StagedOutput::~StagedOutput() = default;

const fs::path& StagedOutput::folder() const { return staging_->folder(); }

void StagedOutput::commit() { staging_->moveTo(target_); }

}  // namespace saw_ndt::internal
