#pragma once

#include <cstddef>
#include <memory>
#include <mutex>

namespace saw_ndt {

/// A progress bar on stderr where that is a terminal; nothing where it is a pipe or a file.
class ProgressBar {
 public:
  /// @param total  how many steps there are
  explicit ProgressBar(std::size_t total);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// One step is done; may be called from several threads.
  void step();

 private:
  struct Display;

  std::mutex mutex_;
  std::unique_ptr<Display> display_;
};

}  // namespace saw_ndt
