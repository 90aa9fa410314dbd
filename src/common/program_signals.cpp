#include "common/program_signals.h"

#include <errno.h>
#include <pthread.h>
#include <semaphore.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <fstream>
#include <iostream>
#include <mutex>
#include <sstream>
#include <string>
#include <thread>

#include "common/unfinished_output.h"

namespace saw_ndt::internal {
namespace {

// A handler can do next to nothing: it wakes a thread that does the work.
struct SignalWatch {
  sem_t arrived;
  std::atomic<int> number{0};
  std::atomic<std::uintptr_t> address{0};  // that could not be read, of SIGBUS
  pid_t process = 0;
};

// Never destroyed: a signal may come while the process exits.
SignalWatch& signalWatch() {
  static SignalWatch& watch = *new SignalWatch;
  return watch;
}

void wakeThread(int number, siginfo_t* info, void*) {
  const int error = errno;
  SignalWatch& watch = signalWatch();
  const bool cannot_go_on = number == SIGBUS && info->si_code > 0;  // not sent by a process
  if (getpid() != watch.process) {
    // A child, which has no such thread and nothing of its own to remove.
    signal(number, SIG_DFL);
    raise(number);
  } else {
    if (cannot_go_on) watch.address = reinterpret_cast<std::uintptr_t>(info->si_addr);
    int none = 0;
    watch.number.compare_exchange_strong(none, number);
    sem_post(&watch.arrived);
    while (cannot_go_on) pause();
  }
  errno = error;
}

// The file that is mapped to an address; empty where there is none.
std::string fileMappedAt(std::uintptr_t address) {
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);) {
    std::istringstream words(line);
    std::uintptr_t begin = 0, end = 0;
    char dash = 0;
    std::string mode, offset, device, inode, path;
    words >> std::hex >> begin >> dash >> end >> mode >> offset >> device >> inode >> std::ws;
    if (!words || address < begin || address >= end) continue;
    std::getline(words, path);
    return path;
  }
  return "";
}

void awaitSignal() {
  SignalWatch& watch = signalWatch();
  while (sem_wait(&watch.arrived) != 0) {
  }
  const std::string file = watch.address != 0 ? fileMappedAt(watch.address) : "";
  if (!file.empty()) {
    std::cerr << std::string(program_invocation_short_name) + ": " + file +
                     ": cannot be read on: it was cut short while it was in use, or its disk fails\n"
              << std::flush;
  }
  endBySignal(watch.number);
}

void watchSignals() {
  SignalWatch& watch = signalWatch();
  watch.process = getpid();
  sem_init(&watch.arrived, 0, 0);
  // The thread is to be in nobody's way, whoever waits for signals.
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  std::thread(awaitSignal).detach();
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGBUS}) {
    struct sigaction action = {};
    sigaction(number, nullptr, &action);
    if (action.sa_handler == SIG_IGN) continue;
    action = {};
    action.sa_sigaction = wakeThread;
    action.sa_flags = SA_RESTART | SA_SIGINFO;
    sigaction(number, &action, nullptr);
  }
  signal(SIGXFSZ, SIG_IGN);
}

}  // namespace

void handleProgramSignals() {
  static std::once_flag once;
  std::call_once(once, watchSignals);
}

}  // namespace saw_ndt::internal
