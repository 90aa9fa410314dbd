#include "common/executor.h"

#include <omp.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "common/helper_pool.h"

namespace saw_ndt::internal {
namespace {

thread_local const HelperSession* current_session = nullptr;

int threadCountOf(const HelperPool& pool, int requested) {
  const int most = pool.size() + 1;
  return requested > 0 ? std::min(requested, most) : most;
}

// As many threads as there are chunks are enough.
int threadCountFor(int threads, std::size_t chunk_count) {
  return static_cast<int>(std::min(static_cast<std::size_t>(threads), chunk_count));
}

void runSerially(std::size_t chunk_count, const ChunkBody& body) {
  const ChunkScope scope;
  for (std::size_t chunk = 0; chunk < chunk_count; ++chunk) body(chunk, 0);
}

}  // namespace

int threadCount(int requested) { return threadCountOf(HelperPool::ofProcess(), requested); }

HelperSession::HelperSession(int threads) : HelperSession(threads, HelperPool::ofProcess()) {}

HelperSession::HelperSession(int threads, HelperPool& pool)
    : pool_(pool), outermost_(current_session == nullptr && !ChunkScope::entered()) {
  if (!outermost_) return;
  first_ = pool_.borrow(threadCountOf(pool_, threads) - 1);
  current_session = this;
}

HelperSession::~HelperSession() {
  if (!outermost_) return;
  current_session = nullptr;
  if (first_ != nullptr) pool_.giveBack(first_);
}

void runChunks(int threads, std::size_t chunk_count, const ChunkBody& body) {
  if (chunk_count >= std::numeric_limits<std::uint32_t>::max()) throw std::length_error("too many chunks in a loop");
  if (chunk_count == 0) return;
  if (threads == 1 || chunk_count == 1 || ChunkScope::entered()) {
    runSerially(chunk_count, body);
    return;
  }
  const HelperSession session(threadCountFor(threadCount(threads), chunk_count));
  const HelperSession& current = *current_session;
  if (current.first_ == nullptr) {
    runSerially(chunk_count, body);
  } else {
    current.pool_.run(*current.first_, chunk_count, threadCountOf(current.pool_, threads), body);
  }
}

void runChunksOffline(int threads, std::size_t chunk_count, const ChunkBody& body) {
  const int workers = threadCountFor(threadCount(threads), chunk_count);
  if (workers <= 1 || ChunkScope::entered()) {
    runSerially(chunk_count, body);
    return;
  }
  ChunkRunner runner;
#pragma omp parallel for num_threads(workers) schedule(dynamic)
  for (std::size_t chunk = 0; chunk < chunk_count; ++chunk) runner.run(body, chunk, omp_get_thread_num());
  runner.rethrow();
}

}  // namespace saw_ndt::internal
