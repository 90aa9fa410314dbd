#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <limits>
#include <memory>
#include <mutex>

namespace saw_ndt::internal {

/// A reference to the body of a parallel loop, which lives as long as the loop. It allocates nothing.
struct ChunkBody {
  void (*call)(void* object, std::size_t chunk, int worker) = nullptr;
  void* object = nullptr;

  void operator()(std::size_t chunk, int worker) const { call(object, chunk, worker); }
};

/// @param body  called as body(std::size_t chunk, int worker)
template <typename Body>
ChunkBody referenceTo(Body& body) {
  return {[](void* object, std::size_t chunk, int worker) { (*static_cast<Body*>(object))(chunk, worker); },
          const_cast<void*>(static_cast<const void*>(std::addressof(body)))};
}

/// While it lives, its thread works on a chunk, and loops that it starts are serial.
class ChunkScope {
 public:
  ChunkScope();
  ~ChunkScope();
  ChunkScope(const ChunkScope&) = delete;
  ChunkScope& operator=(const ChunkScope&) = delete;

  /// Whether the calling thread works on a chunk.
  static bool entered();

 private:
  bool outer_;
};

/// Runs chunks of one loop in several threads and keeps the exception of the lowest-numbered one that fails. Which one
/// that is does not depend on the threads, since all chunks below it are run.
class ChunkRunner {
 public:
  /// For the next loop.
  void reset() { lowest_failed_.store(kNone, std::memory_order_relaxed); }

  /// Runs a chunk unless a lower one has failed. Never throws.
  void run(const ChunkBody& body, std::size_t chunk, int worker);

  /// Throws the exception that was kept, if any. All chunks have ended, and the calling thread knows.
  void rethrow();

 private:
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  void keep(std::size_t chunk, std::exception_ptr failure);

  std::atomic<std::size_t> lowest_failed_{kNone};
  std::mutex mutex_;
  std::exception_ptr failure_;  ///< guarded by mutex_
};

}  // namespace saw_ndt::internal
