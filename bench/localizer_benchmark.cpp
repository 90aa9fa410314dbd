// The whole callback, from a scan in memory to its pose, by every method, with what one makes of PCL's parts beside it:
// pcl::VoxelGrid and pcl::NormalDistributionsTransform.

#include "benchmark_program.h"
#include "benchmark_scans.h"
#include "perturbed_starts.h"
#include "report/pcl_ndt.h"
#include "saw_ndt/localization/localizer.h"
#include "saw_ndt/pcl/cloud_view.h"

namespace {

using saw_ndt::PclNdt;

// An iteration is one scan; all starts are taken equally often.
void localize(benchmark::State& state, const std::string& method_name, int threads) {
  saw_ndt::LocalizerOptions options;
  options.method = saw_ndt::LocalizationMethod::named(method_name);
  options.alignment.threads = threads;
  saw_ndt::Localizer localizer(saw_ndt::benchmarkMap(), options);
  const saw_ndt::ScanView scan = saw_ndt::viewOf(saw_ndt::benchmarkScan());
  saw_ndt::StageTimes sums;
  double evaluations = 0.0;
  std::size_t accepted = 0, source_points = 0;
  while (state.KeepRunningBatch(saw_ndt::kPerturbedStartCount)) {
    for (int k = 0; k < saw_ndt::kPerturbedStartCount; ++k) {
      localizer.setInitialPose(saw_ndt::perturbedStart(saw_ndt::benchmarkPose(), k));
      const saw_ndt::LocalizationResult result = localizer.localize(scan, 0.0);
      sums.segment_ms += result.times.segment_ms;
      sums.filter_ms += result.times.filter_ms;
      sums.align_ms += result.times.align_ms;
      evaluations += result.alignment.evaluations;
      accepted += result.accepted() ? 1u : 0u;
      source_points = result.source_points;
    }
  }
  const auto average = [](double sum) { return benchmark::Counter(sum, benchmark::Counter::kAvgIterations); };
  state.counters["segment_ms"] = average(sums.segment_ms);
  state.counters["filter_ms"] = average(sums.filter_ms);
  state.counters["align_ms"] = average(sums.align_ms);
  state.counters["evaluations"] = average(evaluations);
  state.counters["accepted"] = average(static_cast<double>(accepted));
  state.counters["points"] = static_cast<double>(source_points);
}

void localizeByPcl(benchmark::State& state) {
  static PclNdt ndt(saw_ndt::benchmarkTarget(saw_ndt::kWholeTarget));
  const PclNdt::Cloud::Ptr scan = saw_ndt::benchmarkScanPoints();
  double iterations = 0.0;
  std::size_t source_points = 0;
  while (state.KeepRunningBatch(saw_ndt::kPerturbedStartCount)) {
    for (int k = 0; k < saw_ndt::kPerturbedStartCount; ++k) {
      const PclNdt::Cloud::Ptr source = PclNdt::thinned(scan);
      ndt.setSource(source);
      iterations += ndt.align(saw_ndt::perturbedStart(saw_ndt::benchmarkPose(), k)).iterations;
      source_points = source->size();
    }
  }
  state.counters["pcl_iterations"] = benchmark::Counter(iterations, benchmark::Counter::kAvgIterations);
  state.counters["points"] = static_cast<double>(source_points);
}

}  // namespace

int main(int argc, char** argv) {
  return saw_ndt::runBenchmarkProgram(argc, argv, [] {
    for (const std::string& method : saw_ndt::LocalizationMethod::names()) {
      saw_ndt::registerForEachInstructionSet(
          "callback/" + method, [method](benchmark::State& state, int threads) { localize(state, method, threads); });
    }
    // Ten alignments that take seconds each are repetition enough.
    benchmark::RegisterBenchmark("pcl/callback", localizeByPcl)->Repetitions(1);
  });
}
