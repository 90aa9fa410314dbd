#include "benchmark_program.h"

#include <algorithm>
#include <iostream>

#include "benchmark_scans.h"

namespace saw_ndt {

using namespace internal;

const std::vector<InstructionSet>& availableInstructionSets() {
  static const std::vector<InstructionSet> available = [] {
    std::vector<InstructionSet> sets;
    for (const InstructionSet set : kInstructionSets) {
      const InstructionSetLimit limit(set);
      if (instructionSet() == set) sets.push_back(set);
    }
    return sets;
  }();
  return available;
}

const std::vector<int>& benchmarkThreadCounts() {
  static const std::vector<int> counts = internal::threadCount(0) > 1 ? std::vector<int>{1, 2} : std::vector<int>{1};
  return counts;
}

void registerForEachInstructionSet(const std::string& stage_and_what,
                                   const std::function<void(benchmark::State& state, int threads)>& run,
                                   const std::vector<int>& thread_counts) {
  for (const InstructionSet set : availableInstructionSets()) {
    for (const int threads : thread_counts) {
      const std::string name = stage_and_what + "/" + toString(set) + "/threads:" + std::to_string(threads);
      auto* const registered = benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
        const InstructionSetLimit limit(set);
        run(state, threads);
      });
      if (threads > 1) registered->UseRealTime();
    }
  }
}

void setTimePer(benchmark::State& state, const std::string& name, std::size_t count) {
  state.counters["time_per_" + name] = benchmark::Counter(
      static_cast<double>(count), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

namespace {

int run(int argc, char** argv, const std::function<void()>& add_context_and_benchmarks) {
  try {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    benchmark::AddCustomContext("instruction_set", toString(instructionSet()));
    add_context_and_benchmarks();
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    return 0;
  } catch (const std::exception& error) {
    std::cerr << argv[0] << ": " << error.what() << "\n";
    return 1;
  }
}

}  // namespace

int runBenchmarkProgram(int argc, char** argv, const std::function<void()>& register_benchmarks) {
  return run(argc, argv, [&] {
    benchmark::AddCustomContext("data", benchmarkSequenceDescription() + ", scan " +
                                            std::to_string(benchmarkScanNumber()) + " in the map of " +
                                            std::to_string(benchmarkMapScans().size()) + " others");
    benchmark::AddCustomContext("points", std::to_string(benchmarkScan().size()));
    register_benchmarks();
  });
}

int runSyntheticBenchmarkProgram(int argc, char** argv, const std::function<void()>& register_benchmarks) {
  return run(argc, argv, [&] {
    benchmark::AddCustomContext("data", "synthetic");
    register_benchmarks();
  });
}

}  // namespace saw_ndt
