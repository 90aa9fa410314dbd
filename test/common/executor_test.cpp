#include "common/executor.h"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <numeric>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "common/helper_pool.h"

namespace saw_ndt::internal {
namespace {

// More helpers than most machines of a test have cores: threads that the system puts aside at any point.
HelperPool& manyHelpers() {
  static HelperPool& pool = *new HelperPool(7);
  return pool;
}

std::size_t threadsOfProcess() {
  const std::filesystem::directory_iterator threads("/proc/self/task");
  return static_cast<std::size_t>(std::distance(begin(threads), end(threads)));
}

void waitUntil(const std::atomic<bool>& flag) {
  while (!flag) std::this_thread::yield();
}

// A loop that never ends unless two threads work on it.
void meetInALoop() {
  std::atomic<int> began{0};
  forEachChunk(2, 2, [&](std::size_t, int) {
    ++began;
    while (began < 2) std::this_thread::yield();
  });
}

// Takes some microseconds, also where the result is not used.
double laborious(std::size_t value) {
  volatile double sum = 0.0;
  for (int i = 1; i < 200; ++i) sum = sum + std::sin(static_cast<double>(value) / i);
  return sum;
}

// Both kinds of loops, and those of a session of many helpers.
class Loops : public testing::TestWithParam<std::string> {
 protected:
  template <typename Body>
  void forEach(int threads, std::size_t chunk_count, Body&& body) {
    if (GetParam() == "Offline") {
      forEachChunkOffline(threads, chunk_count, body);
    } else if (GetParam() == "SessionOfMany") {
      const HelperSession session(0, manyHelpers());
      forEachChunk(threads, chunk_count, body);
    } else {
      forEachChunk(threads, chunk_count, body);
    }
  }
  int mostThreads() const { return GetParam() == "SessionOfMany" ? manyHelpers().size() + 1 : threadCount(0); }
};

INSTANTIATE_TEST_SUITE_P(Executor, Loops, testing::Values("Bare", "SessionOfMany", "Offline"),
                         [](const auto& test) { return test.param; });

TEST_P(Loops, RunEveryChunkOnceAndAWorkerAtMostOneChunkAtATime) {
  for (const std::size_t chunk_count : {0U, 1U, 2U, 3U, 8U, 61U, 1000U}) {
    for (const int threads : {0, 1, 2, 3, 8, 100}) {
      const int workers = threads > 0 ? std::min(threads, mostThreads()) : mostThreads();
      std::vector<int> runs(chunk_count, 0);
      std::vector<std::atomic<int>> at_work(static_cast<std::size_t>(workers));
      std::atomic<int> mistakes{0};
      forEach(threads, chunk_count, [&](std::size_t chunk, int worker) {
        if (worker < 0 || worker >= workers || chunk >= chunk_count) {
          ++mistakes;
          return;
        }
        if (++at_work[static_cast<std::size_t>(worker)] != 1) ++mistakes;
        laborious(chunk);
        ++runs[chunk];
        --at_work[static_cast<std::size_t>(worker)];
      });
      ASSERT_EQ(mistakes, 0) << chunk_count << " chunks, " << threads << " threads";
      ASSERT_EQ(runs, std::vector<int>(chunk_count, 1)) << threads << " threads";
    }
  }
}

TEST_P(Loops, GiveTheSameResultsForAnyNumberOfThreads) {
  const auto results = [&](int threads) {
    std::vector<double> sums(100);
    forEach(threads, sums.size(), [&](std::size_t chunk, int) { sums[chunk] = laborious(chunk); });
    return std::accumulate(sums.begin(), sums.end(), 0.0);
  };
  const double serial = results(1);
  for (const int threads : {0, 2, 3, 8}) EXPECT_EQ(results(threads), serial) << threads << " threads";
}

TEST_P(Loops, ThrowTheExceptionOfTheLowestFailingChunkWhenNoneIsAtWork) {
  for (int repetition = 0; repetition < 200; ++repetition) {
    std::atomic<int> at_work{0};
    std::string message;
    try {
      forEach(0, 50, [&](std::size_t chunk, int) {
        ++at_work;
        laborious(chunk);
        // The lower ones fail later than the higher ones.
        if (chunk >= 20) {
          if (chunk < 24) std::this_thread::sleep_for(std::chrono::microseconds(20));
          --at_work;
          throw std::runtime_error("chunk " + std::to_string(chunk));
        }
        --at_work;
      });
    } catch (const std::runtime_error& error) {
      message = error.what();
      EXPECT_EQ(at_work, 0);
    }
    ASSERT_EQ(message, "chunk 20");
  }
  int runs = 0;
  forEach(1, 3, [&](std::size_t, int) { ++runs; });
  EXPECT_EQ(runs, 3);
}

TEST_P(Loops, RunLoopsInsideAChunkSerially) {
  std::vector<int> inner_runs(40, 0);
  std::atomic<int> mistakes{0};
  forEach(0, inner_runs.size(), [&](std::size_t chunk, int) {
    const std::thread::id thread = std::this_thread::get_id();
    const auto body = [&](std::size_t, int worker) {
      if (worker != 0 || std::this_thread::get_id() != thread) ++mistakes;
      ++inner_runs[chunk];
    };
    const HelperSession session(0, manyHelpers());
    forEachChunk(0, 10, body);
    forEachChunkOffline(0, 10, body);
  });
  EXPECT_EQ(mistakes, 0);
  EXPECT_EQ(inner_runs, std::vector<int>(40, 20));
}

TEST(Executor, UsesNoMoreThreadsThanCores) {
  const int cores = threadCount(0);
  EXPECT_GE(cores, 1);
  EXPECT_EQ(threadCount(1), 1);
  EXPECT_EQ(threadCount(cores), cores);
  EXPECT_EQ(threadCount(cores + 1), cores);
  EXPECT_EQ(threadCount(1 << 20), cores);
  EXPECT_EQ(HelperPool::ofProcess().size(), cores - 1);
}

TEST(Executor, HandsOnExceptionsOfCallerAndHelper) {
  const HelperSession session(2, manyHelpers());
  for (const bool helper_fails : {false, true}) {
    std::atomic<bool> caller_began{false}, helper_began{false};
    try {
      // Each of the two takes one of the chunks.
      forEachChunk(2, 2, [&](std::size_t, int worker) {
        (worker == 0 ? caller_began : helper_began) = true;
        waitUntil(worker == 0 ? helper_began : caller_began);
        if ((worker != 0) == helper_fails) throw std::runtime_error(worker == 0 ? "caller" : "helper");
      });
      ADD_FAILURE() << "nothing was thrown";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), helper_fails ? "helper" : "caller");
    }
  }
}

TEST(Executor, GivesALoopAsManyWorkersAsItAsksForAndNoMoreThanTheSession) {
  std::vector<std::atomic<int>> chunks_of_worker(8);
  const auto count = [&](std::size_t chunk, int worker) {
    laborious(chunk);
    ++chunks_of_worker[static_cast<std::size_t>(worker)];
  };
  const HelperSession session(4, manyHelpers());
  const HelperSession joined(8, manyHelpers());
  for (int i = 0; i < 500; ++i) forEachChunk(8, 20, count);
  for (std::size_t worker = 4; worker < 8; ++worker) EXPECT_EQ(chunks_of_worker[worker], 0) << worker;
  for (auto& chunks : chunks_of_worker) chunks = 0;
  for (int i = 0; i < 500; ++i) forEachChunk(2, 20, count);
  EXPECT_EQ(chunks_of_worker[0] + chunks_of_worker[1], 500 * 20);
}

TEST(Executor, HelpersOfASessionAreBackWhenItEnds) {
  static HelperPool& one = *new HelperPool(1);
  for (int repetition = 0; repetition < 100; ++repetition) {
    const HelperSession session(2, one);
    meetInALoop();
  }
}

TEST(Executor, RunsAloneWhereNoHelperIsIdle) {
  static HelperPool& one = *new HelperPool(1);
  const HelperSession session(2, one);
  std::thread other([] {
    const HelperSession alone(2, one);
    int runs = 0;
    forEachChunk(2, 1000, [&](std::size_t, int worker) { runs += worker == 0 ? 1 : 1000000; });
    EXPECT_EQ(runs, 1000);
  });
  other.join();
}

TEST(Executor, ServesASecondThreadWithHelpersOfItsOwn) {
  const HelperSession session(3, manyHelpers());
  std::thread other([] {
    const HelperSession second(2, manyHelpers());
    for (int i = 0; i < 10; ++i) meetInALoop();
  });
  for (int i = 0; i < 10; ++i) meetInALoop();
  other.join();
}

TEST(Executor, SleepingHelpersComeBackToALaterLoopOfTheSession) {
  const HelperSession session(2, manyHelpers());
  for (int repetition = 0; repetition < 20; ++repetition) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    meetInALoop();
  }
}

TEST(Executor, ServesManySessionsOneAfterTheOther) {
  std::uint64_t sum = 0;
  for (std::uint64_t i = 0; i < 100000; ++i) {
    const HelperSession session(2 + static_cast<int>(i % 7), manyHelpers());
    std::array<std::uint64_t, 4> parts{};
    forEachChunk(0, parts.size(), [&](std::size_t chunk, int) { parts[chunk] = i + chunk; });
    sum += std::accumulate(parts.begin(), parts.end(), std::uint64_t{0});
  }
  EXPECT_EQ(sum, 4 * (99999ULL * 100000 / 2) + 6 * 100000);
}

// Sessions of several threads that take each other's helpers all the time.
void useHelpersFromEightThreads(HelperPool& pool, const std::function<void()>& in_between) {
  std::vector<std::thread> callers;
  std::atomic<int> mistakes{0};
  for (int caller = 0; caller < 8; ++caller) {
    callers.emplace_back([&, caller] {
      for (std::size_t i = 0; i < 1000; ++i) {
        const HelperSession session(1 + (caller + static_cast<int>(i)) % 8, pool);
        for (const std::size_t chunk_count : {5U, 17U}) {
          std::vector<std::size_t> results(chunk_count, 0);
          std::vector<std::atomic<int>> at_work(static_cast<std::size_t>(pool.size() + 1));
          forEachChunk(0, chunk_count, [&](std::size_t chunk, int worker) {
            std::atomic<int>& chunks_of_worker = at_work[static_cast<std::size_t>(worker)];
            if (++chunks_of_worker != 1) ++mistakes;
            laborious(chunk);
            results[chunk] += chunk + i;
            --chunks_of_worker;
          });
          for (std::size_t chunk = 0; chunk < chunk_count; ++chunk) mistakes += results[chunk] != chunk + i ? 1 : 0;
        }
      }
    });
  }
  in_between();
  for (std::thread& caller : callers) caller.join();
  EXPECT_EQ(mistakes, 0);
}

TEST(Executor, ServesEightThreadsAtOnce) {
  useHelpersFromEightThreads(manyHelpers(), [] {});
}

TEST(Executor, AddsOneThreadLessThanCoresForAllCallersTogether) {
  const std::size_t before = threadsOfProcess();
  const auto most = before + 8 + static_cast<std::size_t>(threadCount(0)) - 1;
  useHelpersFromEightThreads(HelperPool::ofProcess(), [&] {
    for (int i = 0; i < 100; ++i) {
      EXPECT_LE(threadsOfProcess(), most);
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
  });
}

// Runs a loop in a forked process and returns whether that thread ran all of it and keeps its processors.
bool worksAloneInAForkedProcess() {
  const pid_t child = fork();
  if (child == 0) {
    cpu_set_t before, after;
    sched_getaffinity(0, sizeof(before), &before);
    const std::thread::id caller = std::this_thread::get_id();
    std::size_t own_chunks = 0;
    for (int i = 0; i < 10; ++i) {
      const HelperSession session(0, manyHelpers());
      forEachChunk(0, 20, [&](std::size_t, int) { own_chunks += std::this_thread::get_id() == caller ? 1 : 0; });
    }
    sched_getaffinity(0, sizeof(after), &after);
    _exit(own_chunks == 200 && CPU_EQUAL(&before, &after) ? 0 : 1);
  }
  int status = -1;
  return waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

TEST(Executor, WorksAloneInAForkedProcess) {
  {
    const HelperSession session(0, manyHelpers());
    meetInALoop();
    EXPECT_TRUE(worksAloneInAForkedProcess()) << "in a session that was begun before";
  }
  EXPECT_TRUE(worksAloneInAForkedProcess());
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_TRUE(worksAloneInAForkedProcess()) << "helpers sleep";
}

TEST(Executor, RefusesMoreChunksThanATicketCounts) {
  EXPECT_THROW(forEachChunk(2, 0xFFFFFFFF, [](std::size_t, int) {}), std::length_error);
}

}  // namespace
}  // namespace saw_ndt::internal
