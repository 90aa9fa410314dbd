#include "common/chunk_body.h"

#include <utility>

namespace saw_ndt::internal {
namespace {

thread_local bool works_on_chunk = false;

}  // namespace

ChunkScope::ChunkScope() : outer_(std::exchange(works_on_chunk, true)) {}

ChunkScope::~ChunkScope() { works_on_chunk = outer_; }

bool ChunkScope::entered() { return works_on_chunk; }

void ChunkRunner::run(const ChunkBody& body, std::size_t chunk, int worker) {
  if (chunk > lowest_failed_.load(std::memory_order_relaxed)) return;
  try {
    const ChunkScope scope;
    body(chunk, worker);
  } catch (...) {
    keep(chunk, std::current_exception());
  }
}

void ChunkRunner::keep(std::size_t chunk, std::exception_ptr failure) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (chunk > lowest_failed_.load(std::memory_order_relaxed)) return;
  lowest_failed_.store(chunk, std::memory_order_relaxed);
  failure_ = std::move(failure);
}

void ChunkRunner::rethrow() {
  if (lowest_failed_.load(std::memory_order_relaxed) == kNone) return;
  reset();
  std::rethrow_exception(std::exchange(failure_, nullptr));
}

}  // namespace saw_ndt::internal
