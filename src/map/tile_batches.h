#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "common/executor.h"

namespace saw_ndt::internal {

/// Does work on many tiles, a few megabytes of them at a time: in memory is what one batch needs. Work is prepared by
/// several threads and finished in its order.
/// @tparam Task     what is known of a tile before; `byte_count` tells what it will read
/// @tparam Scratch  memory of a thread
/// @tparam Result   of a task
/// @param next      next(task) makes the next task and returns true, or false where there is none
/// @param prepare   prepare(task, scratch, result) by several threads at a time
/// @param finish    finish(task, result), one after the other in the order of next()
template <typename Task, typename Scratch, typename Result, typename Next, typename Prepare, typename Finish>
void forEachTileInBatches(int threads, const Next& next, const Prepare& prepare, const Finish& finish) {
  constexpr std::uint64_t kBatchBytes = std::uint64_t{4} << 20U;
  constexpr std::size_t kMostTasks = 1024;
  std::vector<Scratch> scratches(static_cast<std::size_t>(threadCount(threads)));
  std::vector<Task> tasks;
  for (bool more = true; more;) {
    tasks.clear();
    for (std::uint64_t bytes = 0; bytes < kBatchBytes && tasks.size() < kMostTasks; bytes += tasks.back().byte_count) {
      Task task;
      more = next(task);
      if (!more) break;
      tasks.push_back(std::move(task));
    }
    std::vector<Result> results(tasks.size());
    forEachChunkOffline(threads, tasks.size(), [&](std::size_t i, int worker) {
      prepare(tasks[i], scratches[static_cast<std::size_t>(worker)], results[i]);
    });
    for (std::size_t i = 0; i < tasks.size(); ++i) finish(tasks[i], results[i]);
  }
}

}  // namespace saw_ndt::internal
