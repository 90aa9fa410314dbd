#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "common/chunk_body.h"

namespace saw_ndt::internal {

/// What different threads write lies this far apart, so that they do not take it from each other's caches.
constexpr std::size_t kCacheLine_bytes = 64;

/// How often a thread looks for what it waits for before it leaves the processor to others: for 30 to 130 us on an x86
/// processor.
constexpr int kSpins = 2000;

/// Tells the processor that the thread spins.
inline void pauseThread() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

/// Whom a helper serves; each value is given out once.
using Assignment = std::uint64_t;

/// Loops of one thread, one after the other, whose chunks helpers may take. A helper that comes late, or that the
/// system puts aside at any point, takes no chunk of a loop that is not its own, and is waited for only if it has taken
/// one.
///
/// All goes through the ticket: the number of the loop and that of the next chunk. A helper reads the ticket, then what
/// the loop is, and takes the chunk by exchanging the very ticket that it read. A ticket is closed before the next loop
/// is written down: what was read of another loop than the ticket's is not used.
class SharedLoop {
 public:
  SharedLoop() = default;
  SharedLoop(const SharedLoop&) = delete;
  SharedLoop& operator=(const SharedLoop&) = delete;

  /// Lets helpers take chunks. For one thread at a time, which calls complete() next.
  /// @param chunk_count  less than 2^32 - 1
  /// @param workers      that may work, the calling thread included
  /// @param body         called as body(chunk, worker) for each chunk
  void open(std::size_t chunk_count, int workers, const ChunkBody& body);

  /// Runs the chunks that are left, as worker 0, and waits for those that helpers have taken.
  /// @throws what the lowest-numbered failing chunk threw
  void complete();

  /// A helper takes a chunk and runs it. Returns whether there was one.
  /// @param assignment  whom the helper serves, looked at once the ticket is read
  /// @param mine        its value while the helper serves this loop's thread
  bool help(int worker, const std::atomic<Assignment>& assignment, Assignment mine);

  /// Whether there seems to be a chunk for a helper.
  bool hasChunkFor(int worker) const;

 private:
  static constexpr std::uint64_t kChunkMask = 0xFFFFFFFF;
  static constexpr std::uint64_t kClosed = kChunkMask;
  static constexpr std::uint64_t kNextLoop = kChunkMask + 1;

  alignas(kCacheLine_bytes) std::atomic<std::uint64_t> ticket_{kClosed};
  // What the loop is, written while the ticket is closed.
  alignas(kCacheLine_bytes) std::atomic<std::uint32_t> chunk_count_{0};
  std::atomic<int> workers_{0};
  std::atomic<void (*)(void*, std::size_t, int)> call_{nullptr};
  std::atomic<void*> object_{nullptr};
  ChunkRunner runner_;
  alignas(kCacheLine_bytes) std::atomic<std::uint32_t> finished_{0};  ///< chunks that helpers have ended
};

}  // namespace saw_ndt::internal
