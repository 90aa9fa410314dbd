#pragma once

#include <cstddef>

#include "common/chunk_body.h"
#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

class HelperPool;
struct Helper;

// How loops run in parallel. Real-time loops, which somebody waits for, must be quick also on a processor that other
// programs use: forEachChunk(), where a thread that the system has put aside holds up nobody unless it is in the middle
// of a chunk. Loops that run for long, such as those that make maps, are forEachChunkOffline().

/// The number of threads that work where so many are asked for: that, but at most the cores that the process had at
/// first use, and these for 0.
SAW_NDT_EXPORT int threadCount(int requested);

/// While it lives, the loops that its thread starts share the same helpers, which are woken once and look out for
/// chunks between loops too, so that a loop starts at once. After some 100 us without one they sleep until the next. A
/// session inside another one on the same thread, or inside a chunk, does nothing: its loops belong to the outer one.
///
/// Helpers are threads of the process, one less than cores for all callers together, made when first needed. A session
/// gets those that are idle when it begins, perhaps none; a forked process has none.
class SAW_NDT_EXPORT HelperSession {
 public:
  /// @param threads  that work, with the calling one; 0 is all cores
  explicit HelperSession(int threads);
  /// @param pool  whose helpers are used
  HelperSession(int threads, HelperPool& pool);
  ~HelperSession();
  HelperSession(const HelperSession&) = delete;
  HelperSession& operator=(const HelperSession&) = delete;

 private:
  friend void runChunks(int threads, std::size_t chunk_count, const ChunkBody& body);

  HelperPool& pool_;
  bool outermost_;
  Helper* first_ = nullptr;
};

// What the templates below stand on.
SAW_NDT_EXPORT void runChunks(int threads, std::size_t chunk_count, const ChunkBody& body);
SAW_NDT_EXPORT void runChunksOffline(int threads, std::size_t chunk_count, const ChunkBody& body);

/// Calls body(std::size_t chunk, int worker) once for each chunk, in several threads, the calling one among them, and
/// returns when all is done. Chunks go to who is free, so what a body computes must depend on the chunk alone. `worker`
/// is for scratch memory: it is less than threadCount(threads), that of the calling thread is 0, and no two chunks of
/// one worker run at once. A loop that a body starts is serial. Without a HelperSession a loop is one of its own.
///
/// Where a chunk throws, the exception of the lowest-numbered failing one comes out once all that were begun have
/// ended; chunks above it may be left out.
/// @param threads  that work, with the calling one; 0 is all cores. A session has at most its own.
template <typename Body>
void forEachChunk(int threads, std::size_t chunk_count, Body&& body) {
  runChunks(threads, chunk_count, referenceTo(body));
}

/// The same for work that nobody waits for, with threads of OpenMP. Its worker is in [0, threadCount(threads)) too.
template <typename Body>
void forEachChunkOffline(int threads, std::size_t chunk_count, Body&& body) {
  runChunksOffline(threads, chunk_count, referenceTo(body));
}

}  // namespace saw_ndt::internal
