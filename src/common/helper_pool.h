#pragma once

#include <pthread.h>
#include <sched.h>
#include <semaphore.h>
#include <sys/types.h>

#include <atomic>
#include <cstdint>
#include <memory>

#include "common/shared_loop.h"

namespace saw_ndt::internal {

/// A thread that serves one session after the other and sleeps in between.
struct alignas(kCacheLine_bytes) Helper {
  Helper() { sem_init(&wake, 0, 0); }
  ~Helper() { sem_destroy(&wake); }

  Helper* all = nullptr;                  ///< the first helper of the pool
  std::atomic<Assignment> assignment{0};  ///< written by sessions alone; 0: idle
  std::atomic<bool> asleep{false};        ///< or about to be; `wake` is posted by who clears it
  sem_t wake;

  // Of the session that holds the helper.
  bool started = false;
  pthread_t thread{};
  int avoided_cpu = -1;    ///< where it may not run
  Helper* next = nullptr;  ///< the session's next helper

  SharedLoop loop;  ///< of the session whose first helper this is
};

/// Helpers for the loops of any number of threads. Its threads never end, and so it is never destroyed.
class HelperPool {
 public:
  /// The helpers of the process: one less than cores.
  static HelperPool& ofProcess();

  explicit HelperPool(int helper_count);
  ~HelperPool() = delete;
  HelperPool(const HelperPool&) = delete;
  HelperPool& operator=(const HelperPool&) = delete;

  int size() const { return helper_count_; }

  /// Begins a session: takes up to `most` idle helpers, makes threads of those that are none yet, and wakes them.
  /// @return the first, which links the others; null where none is idle
  Helper* borrow(int most);

  /// Runs a loop of a session, see SharedLoop.
  void run(Helper& first, std::size_t chunk_count, int workers, const ChunkBody& body) const;

  /// Ends a session. Its helpers may still be awake, but take no chunk any more.
  static void giveBack(Helper* first);

 private:
  static bool start(Helper& helper);
  void wakeUp(Helper& helper) const;
  bool isForked() const;  ///< whether this is a copy of the pool in a child process, where threads are not copied

  int helper_count_;
  std::unique_ptr<Helper[]> helpers_;
  pid_t process_;
  std::atomic<std::uint32_t> session_count_{0};
};

}  // namespace saw_ndt::internal
