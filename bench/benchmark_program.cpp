#include "benchmark_program.h"

#include <algorithm>
#include <iostream>

#include "benchmark_scans.h"

namespace saw_ndt {

const std::vector<InstructionSet>& availableInstructionSets() {
  static const std::vector<InstructionSet> available = [] {
    std::vector<InstructionSet> sets;
    for (const InstructionSet set : {InstructionSet::BASELINE, InstructionSet::AVX2, InstructionSet::AVX512}) {
      const InstructionSetLimit limit(set);
      if (instructionSet() == set) sets.push_back(set);
    }
    return sets;
  }();
  return available;
}

const std::vector<int>& benchmarkThreadCounts() {
  static const std::vector<int> counts = threadCount(0) > 1 ? std::vector<int>{1, 2} : std::vector<int>{1};
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
  // A rate of units of 1e-9 is, inverted, in nanoseconds.
  state.counters["ns_per_" + name] = benchmark::Counter(
      1e-9 * static_cast<double>(count), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

int runBenchmarkProgram(int argc, char** argv, const std::function<void()>& register_benchmarks) {
  try {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    benchmark::AddCustomContext("data", benchmarkSequenceDescription() + ", scan " +
                                            std::to_string(benchmarkScanNumber()) + " in the map of " +
                                            std::to_string(benchmarkMapScans().size()) + " others");
    benchmark::AddCustomContext("points", std::to_string(benchmarkScan().size()));
    benchmark::AddCustomContext("instruction_set", toString(instructionSet()));
    register_benchmarks();
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    return 0;
  } catch (const std::exception& error) {
    std::cerr << argv[0] << ": " << error.what() << "\n";
    return 1;
  }
}

}  // namespace saw_ndt
