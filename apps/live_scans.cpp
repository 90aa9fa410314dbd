#include "live_scans.h"

#include <pthread.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "common/unfinished_output.h"
#include "drives/followed_folder.h"
#include "drives/live_address.h"
#include "drives/velodyne_socket.h"
#include "saw_ndt/io/trajectory.h"

namespace saw_ndt {

Interruption::Interruption() {
  sigemptyset(&signals_);
  sigaddset(&signals_, SIGINT);
  sigaddset(&signals_, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
}

Interruption::~Interruption() {
  if (!thread_.joinable()) return;
  ended_ = true;
  pthread_kill(thread_.native_handle(), SIGINT);
  thread_.join();
}

void Interruption::onFirst(std::function<void()> call) {
  thread_ = std::thread([this, call = std::move(call)] {
    int signal = 0;
    sigwait(&signals_, &signal);
    if (ended_) return;
    call();
    sigwait(&signals_, &signal);
    if (!ended_) internal::endBySignal(signal);
  });
}

namespace {

std::optional<internal::LiveAddress> parseUdp(const LocalizeArguments& arguments) {
  return checkedUsage([&] { return internal::parseUdpAddress(arguments.sequence); });
}

}  // namespace

std::vector<ScanPoints> LiveScans::waitForFirst() {
  std::vector<ScanPoints> points;
  RecordedScan scan;
  while (first_.size() < kFirstScans && source_.next(scan)) {
    if (scan.failure.empty()) points.push_back(scan);
    first_.push_back(std::move(scan));
    scan = RecordedScan();
  }
  return points;
}

double LiveScans::scanPeriod() const {
  double least_s = 0.0;  // scans may be left out between two
  for (std::size_t i = 1; i < first_.size(); ++i) {
    const double period_s = first_[i].stamp_s - first_[i - 1].stamp_s;
    if (period_s > 0.0 && (least_s == 0.0 || period_s < least_s)) least_s = period_s;
  }
  return least_s > 0.0 ? least_s : kNominalScanPeriod_s;
}

bool LiveScans::next(RecordedScan& scan) {
  if (first_.empty()) return source_.next(scan);
  scan = std::move(first_.front());
  first_.pop_front();
  return true;
}

bool isLive(const LocalizeArguments& arguments) { return arguments.follow || parseUdp(arguments).has_value(); }

std::unique_ptr<LiveSource> openLive(const LocalizeArguments& arguments) {
  const auto max_waiting = static_cast<std::size_t>(arguments.max_waiting);
  if (const auto udp = parseUdp(arguments)) {
    return internal::listenToVelodyne(udp->address, udp->port, arguments.recording.velodyneCalibration(), max_waiting);
  }
  return internal::followFolder(arguments.sequence, arguments.recording.binFields(), max_waiting);
}

}  // namespace saw_ndt
