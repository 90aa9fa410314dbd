#include "common/shared_loop.h"

#include <chrono>
#include <thread>

namespace saw_ndt::internal {

void SharedLoop::open(std::size_t chunk_count, int workers, const ChunkBody& body) {
  // Released, so that a helper that reads one of these finds the ticket closed.
  chunk_count_.store(static_cast<std::uint32_t>(chunk_count), std::memory_order_release);
  workers_.store(workers, std::memory_order_release);
  call_.store(body.call, std::memory_order_release);
  object_.store(body.object, std::memory_order_release);
  finished_.store(0, std::memory_order_relaxed);
  runner_.reset();
  // In one order with the looks of helpers that go to sleep.
  ticket_.store((ticket_.load(std::memory_order_relaxed) & ~kChunkMask) + kNextLoop, std::memory_order_seq_cst);
}

void SharedLoop::complete() {
  const std::uint32_t chunk_count = chunk_count_.load(std::memory_order_relaxed);
  const ChunkBody body = {call_.load(std::memory_order_relaxed), object_.load(std::memory_order_relaxed)};
  std::uint32_t taken = 0;
  for (;; ++taken) {
    const std::uint64_t chunk = ticket_.fetch_add(1, std::memory_order_relaxed) & kChunkMask;
    if (chunk >= chunk_count) break;
    runner_.run(body, chunk, 0);
  }
  for (int spin = 0; finished_.load(std::memory_order_acquire) != chunk_count - taken; ++spin) {
    if (spin < kSpins) {
      pauseThread();
    } else {
      // The helper was put aside, perhaps for this very thread.
      std::this_thread::sleep_for(std::chrono::microseconds(50));
    }
  }
  ticket_.store(ticket_.load(std::memory_order_relaxed) | kClosed, std::memory_order_relaxed);
  runner_.rethrow();
}

bool SharedLoop::help(int worker, const std::atomic<Assignment>& assignment, Assignment mine) {
  std::uint64_t ticket = ticket_.load(std::memory_order_acquire);
  const std::uint64_t chunk = ticket & kChunkMask;
  if (chunk >= chunk_count_.load(std::memory_order_acquire)) return false;
  if (worker >= workers_.load(std::memory_order_acquire)) return false;
  const ChunkBody body = {call_.load(std::memory_order_acquire), object_.load(std::memory_order_acquire)};
  // The ticket may be of a thread that uses the loop now: that thread began after this helper was dismissed.
  if (assignment.load(std::memory_order_relaxed) != mine) return false;
  if (!ticket_.compare_exchange_strong(ticket, ticket + 1, std::memory_order_acquire, std::memory_order_relaxed)) {
    return false;
  }
  runner_.run(body, chunk, worker);
  finished_.fetch_add(1, std::memory_order_release);
  return true;
}

bool SharedLoop::hasChunkFor(int worker) const {
  return (ticket_.load(std::memory_order_seq_cst) & kChunkMask) < chunk_count_.load(std::memory_order_relaxed) &&
         worker < workers_.load(std::memory_order_relaxed);
}

}  // namespace saw_ndt::internal
