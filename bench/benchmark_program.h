#pragma once

#include <benchmark/benchmark.h>

#include <functional>
#include <string>
#include <vector>

#include "common/executor.h"
#include "common/instruction_set.h"

namespace saw_ndt {

// What the Google Benchmark programs share.

/// The instruction sets that this processor has and the environment variable SAW_NDT_INSTRUCTION_SET allows.
const std::vector<internal::InstructionSet>& availableInstructionSets();

/// Limits the instruction set while it lives; what is used before and after is the best one.
class InstructionSetLimit {
 public:
  explicit InstructionSetLimit(internal::InstructionSet most) { internal::limitInstructionSet(most); }
  ~InstructionSetLimit() { internal::limitInstructionSet(internal::InstructionSet::AVX512); }
  InstructionSetLimit(const InstructionSetLimit&) = delete;
  InstructionSetLimit& operator=(const InstructionSetLimit&) = delete;
};

/// Numbers of threads that are measured: 1, and 2 where there are as many cores.
const std::vector<int>& benchmarkThreadCounts();

/// A benchmark of this project's, named "STAGE_AND_WHAT/INSTRUCTION_SET/threads:N", once for each instruction set and
/// number of threads. That of several threads is timed by the wall clock (Google Benchmark adds "/real_time" to its
/// name), that of one by its own CPU time, which other programs disturb less.
/// @param stage_and_what  such as "evaluate/weighted"
/// @param run             the benchmark, with the number of threads to use; the instruction set is set
void registerForEachInstructionSet(const std::string& stage_and_what,
                                   const std::function<void(benchmark::State& state, int threads)>& run,
                                   const std::vector<int>& thread_counts = benchmarkThreadCounts());

/// Sets the counter "time_per_NAME": the time of an iteration, spread over `count` (s; the console writes ns or so).
void setTimePer(benchmark::State& state, const std::string& name, std::size_t count);

/// main() of a Google Benchmark program: reads its command line, states the data, its size and the instruction set in
/// use, registers and runs the benchmarks. Returns the exit code; an exception is one line on stderr and 1.
int runBenchmarkProgram(int argc, char** argv, const std::function<void()>& register_benchmarks);

/// The same for a program that makes its own data.
int runSyntheticBenchmarkProgram(int argc, char** argv, const std::function<void()>& register_benchmarks);

}  // namespace saw_ndt
