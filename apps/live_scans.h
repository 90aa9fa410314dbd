#pragma once

#include <atomic>
#include <csignal>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "localize_arguments.h"
#include "saw_ndt/drives/live_source.h"

namespace saw_ndt {

/// Keeps SIGINT and SIGTERM from ending the program: the first one calls a function instead, from a thread of its own,
/// a second one ends the program at once. To be made before other threads, so that none of them takes the signals.
class Interruption {
 public:
  Interruption();
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  /// What the first signal calls, also one that came before. To be called once.
  void onFirst(std::function<void()> call);

 private:
  sigset_t signals_;
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

/// The scans of a live source, the first ones of which can be looked at before they are given.
class LiveScans : public ScanSource {
 public:
  explicit LiveScans(LiveSource& source) : source_(source) {}

  /// Waits for the first few scans, as long as the source lasts, and returns the points of those that can be read.
  std::vector<ScanPoints> waitForFirst();
  /// How long a scan takes (s), by the stamps of those.
  double scanPeriod() const;

  bool next(RecordedScan& scan) override;
  std::optional<std::size_t> scanCount() const override { return std::nullopt; }

 private:
  LiveSource& source_;
  std::deque<RecordedScan> first_;
};

/// Whether the command line names a live source.
bool isLive(const LocalizeArguments& arguments);
/// Opens it. @throws Error, UsageError
std::unique_ptr<LiveSource> openLive(const LocalizeArguments& arguments);

}  // namespace saw_ndt
