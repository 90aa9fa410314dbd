#include "drives/followed_folder.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <deque>
#include <string>
#include <vector>

#include "drives/scan_folder.h"
#include "io/bin_scan.h"
#include "io/pcd_fields.h"
#include "io/stamp_seconds.h"
#include "io/stamp_text.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/io/scan_file.h"

namespace saw_ndt::internal {

namespace fs = std::filesystem;

namespace {

/// A file descriptor that is closed with this object.
class Descriptor {
 public:
  Descriptor(int descriptor, const fs::path& path) : descriptor_(descriptor) {
    if (descriptor < 0) throw Error(path.string(), "", std::string("cannot be watched: ") + std::strerror(errno));
  }
  ~Descriptor() { close(descriptor_); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  operator int() const { return descriptor_; }

 private:
  int descriptor_;
};

double changeTime(const fs::path& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) return 0.0;
  return stampSeconds(status.st_mtim.tv_sec, status.st_mtim.tv_nsec);
}

class FollowedFolder : public LiveSource {
 public:
  FollowedFolder(const fs::path& folder, int bin_fields, std::size_t max_waiting)
      : folder_(folder),
        bin_fields_(bin_fields),
        max_waiting_(max_waiting),
        events_(inotify_init1(IN_NONBLOCK | IN_CLOEXEC), folder),
        stop_event_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC), folder) {
    requireBinFields(bin_fields);
    // Watched first, then listed: a file that comes meanwhile is told twice, which takeFile() sees.
    if (inotify_add_watch(events_, folder.c_str(), IN_CLOSE_WRITE | IN_MOVED_TO | IN_ONLYDIR) < 0) {
      throw Error(folder.string(), "", std::strerror(errno));
    }
    listFolder();
  }

  bool next(RecordedScan& scan) override {
    while (!stopped_) {
      takeEvents();
      if (!waiting_.empty()) {
        if (waiting_.size() > max_waiting_) {
          left_out_ += waiting_.size() - 1;
          number_ += static_cast<int>(waiting_.size()) - 1;
          waiting_.erase(waiting_.begin(), waiting_.end() - 1);
        }
        const std::string name = waiting_.front();
        waiting_.pop_front();
        read(name, scan);
        return true;
      }
      std::array<pollfd, 2> descriptors = {{{events_, POLLIN, 0}, {stop_event_, POLLIN, 0}}};
      constexpr int kForever_ms = -1;
      if (poll(descriptors.data(), descriptors.size(), kForever_ms) < 0 && errno != EINTR) {
        throw Error(folder_.string(), "", std::strerror(errno));
      }
    }
    return false;
  }

  void stop() override {
    stopped_ = true;
    constexpr std::uint64_t kOne = 1;
    // It cannot fail but where the event is set already.
    [[maybe_unused]] const ssize_t written = write(stop_event_, &kOne, sizeof(kOne));
  }
  std::size_t leftOut() const override { return left_out_; }
  std::size_t rejected() const override { return rejected_; }

 private:
  void listFolder() {
    std::vector<fs::path> files;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
      if (entry.is_regular_file() && isScanFile(entry.path())) files.push_back(entry.path());
    }
    sortScans(files);
    for (const fs::path& file : files) takeFile(file.filename().string());
  }

  void takeEvents() {
    alignas(inotify_event) std::array<char, 16384> bytes;
    for (;;) {
      const ssize_t size = ::read(events_, bytes.data(), bytes.size());
      if (size <= 0) return;
      for (ssize_t at = 0; at < size;) {
        const auto* event = reinterpret_cast<const inotify_event*>(bytes.data() + at);
        at += static_cast<ssize_t>(sizeof(inotify_event) + event->len);
        if ((event->mask & IN_Q_OVERFLOW) != 0) {
          listFolder();
        } else if (event->len > 0) {
          takeFile(event->name);
        }
      }
    }
  }

  /// Puts a file behind those that wait, or moves it there where it was written again.
  void takeFile(const std::string& name) {
    if (!isScanFile(name)) {
      ++rejected_;
      return;
    }
    if (name == last_read_ && changeTime(folder_ / name) == last_change_s_) return;
    waiting_.erase(std::remove(waiting_.begin(), waiting_.end(), name), waiting_.end());
    waiting_.push_back(name);
  }

  void read(const std::string& name, RecordedScan& scan) {
    const fs::path file = folder_ / name;
    last_read_ = name;
    last_change_s_ = changeTime(file);
    scan.number = number_++;
    scan.name = name;
    scan.stamp_s = stampOfName(file.stem().string()).value_or(last_change_s_);
    scan.T_map_lidar.reset();
    scan.priors = {};
    scan.failure.clear();
    try {
      if (bin_fields_ == 0 && isBinScan(file)) bin_fields_ = tellBinFields(file).value_or(0);
      readScanPoints(file, scan, isBinScan(file) ? bin_fields_ : 0);
    } catch (const Error& error) {
      static_cast<ScanPoints&>(scan) = ScanPoints();
      scan.failure = error.what();
    }
  }

  fs::path folder_;
  int bin_fields_;  // 0: not told yet
  std::size_t max_waiting_;
  Descriptor events_, stop_event_;
  std::deque<std::string> waiting_;  // names, the newest at the end
  std::string last_read_;
  double last_change_s_ = 0.0;
  int number_ = 0;
  std::atomic<bool> stopped_{false};
  std::atomic<std::size_t> left_out_{0}, rejected_{0};
};

}  // namespace

std::unique_ptr<LiveSource> followFolder(const fs::path& folder, int bin_fields, std::size_t max_waiting) {
  return std::make_unique<FollowedFolder>(folder, bin_fields, max_waiting);
}

}  // namespace saw_ndt::internal
