#include "common/unfinished_output.h"

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <mutex>
#include <set>
#include <system_error>

namespace saw_ndt::internal {

namespace fs = std::filesystem;

namespace {

constexpr int kEndedBySignal = 128;

struct Unfinished {
  std::mutex mutex;
  std::set<const UnfinishedOutput*> outputs;
};

// Never destroyed: a signal may come while the process exits.
Unfinished& unfinished() {
  static Unfinished& all = *new Unfinished;
  return all;
}

void removeAll(const fs::path& path) {
  // Another thread, or another program at work for this one, may still put files into a folder.
  constexpr int kTries = 100;
  std::error_code error;
  for (int i = 0; i < kTries; ++i) {
    fs::remove_all(path, error);
    if (!error) return;
  }
}

}  // namespace

UnfinishedOutput::UnfinishedOutput(const std::function<fs::path()>& make) {
  Unfinished& all = unfinished();
  const std::lock_guard<std::mutex> lock(all.mutex);
  all.outputs.insert(this);
  try {
    path_ = make();
  } catch (...) {
    all.outputs.erase(this);
    throw;
  }
}

UnfinishedOutput::~UnfinishedOutput() {
  Unfinished& all = unfinished();
  const std::lock_guard<std::mutex> lock(all.mutex);
  if (all.outputs.erase(this) == 0 || path_.empty()) return;
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

void UnfinishedOutput::finish(const std::function<void()>& publish) {
  Unfinished& all = unfinished();
  const std::lock_guard<std::mutex> lock(all.mutex);
  publish();
  all.outputs.erase(this);
}

void endBySignal(int signal_number) {
  Unfinished& all = unfinished();
  all.mutex.lock();  // for good: nothing is begun or finished any more
  for (const UnfinishedOutput* output : all.outputs) {
    if (!output->path().empty()) removeAll(output->path());
  }
  signal(signal_number, SIG_DFL);
  sigset_t mask;
  sigemptyset(&mask);
  sigaddset(&mask, signal_number);
  pthread_sigmask(SIG_UNBLOCK, &mask, nullptr);
  raise(signal_number);
  _exit(kEndedBySignal + signal_number);
}

}  // namespace saw_ndt::internal
