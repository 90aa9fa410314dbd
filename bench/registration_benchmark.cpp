// One evaluation of score, gradient and Hessian on a real scan, and whole alignments from perturbed starts, with
// pcl::NormalDistributionsTransform beside them.

#include "benchmark_program.h"
#include "benchmark_scans.h"
#include "common/executor.h"
#include "perturbed_starts.h"
#include "registration/ndt_evaluation.h"
#include "registration_case.h"
#include "report/pcl_ndt.h"

namespace {

using saw_ndt::PclNdt;
using saw_ndt::RegistrationCase;

void evaluate(benchmark::State& state, const RegistrationCase& scan, int threads) {
  saw_ndt::AlignmentOptions options = scan.options;
  options.threads = threads;
  saw_ndt::internal::NdtEvaluation source;
  source.begin(scan.target, scan.source, options);
  const saw_ndt::internal::Evaluation evaluation = source.onMatchingLevels(saw_ndt::benchmarkPose());
  saw_ndt::internal::NdtDerivatives derivatives;
  const saw_ndt::internal::HelperSession session(threads);  // as an alignment has
  for (auto _ : state) {
    derivatives = evaluation(saw_ndt::benchmarkPose());
    benchmark::DoNotOptimize(derivatives);
  }
  saw_ndt::setTimePer(state, "pair", derivatives.pair_count);
  saw_ndt::setTimePer(state, "point", scan.source.size());
  state.counters["points"] = static_cast<double>(scan.source.size());
  state.counters["pairs_per_point"] =
      static_cast<double>(derivatives.pair_count) / static_cast<double>(scan.source.size());
}

// An iteration is one alignment; all starts are taken equally often.
void align(benchmark::State& state, const RegistrationCase& scan, int threads) {
  saw_ndt::AlignmentOptions options = scan.options;
  options.threads = threads;
  saw_ndt::NdtAligner aligner;
  double evaluations = 0.0;
  while (state.KeepRunningBatch(saw_ndt::kPerturbedStartCount)) {
    for (int k = 0; k < saw_ndt::kPerturbedStartCount; ++k) {
      const Eigen::Isometry3d T_start = saw_ndt::perturbedStart(saw_ndt::benchmarkPose(), k);
      evaluations += aligner.align(scan.target, scan.source, T_start, options).evaluations;
    }
  }
  state.counters["evaluations"] = benchmark::Counter(evaluations, benchmark::Counter::kAvgIterations);
  state.counters["points"] = static_cast<double>(scan.source.size());
}

PclNdt& pclNdt() {
  static PclNdt ndt(saw_ndt::benchmarkTarget(saw_ndt::kWholeTarget));
  return ndt;
}

PclNdt::Cloud::Ptr pclSource() {
  static const PclNdt::Cloud::Ptr source = PclNdt::thinned(saw_ndt::benchmarkScanPoints());
  return source;
}

void evaluateByPcl(benchmark::State& state) {
  PclNdt& ndt = pclNdt();
  ndt.setSource(pclSource());
  for (auto _ : state) benchmark::DoNotOptimize(ndt.evaluate(saw_ndt::benchmarkPose()));
  const std::size_t pairs = ndt.pairCount(saw_ndt::benchmarkPose());
  saw_ndt::setTimePer(state, "pair", pairs);
  saw_ndt::setTimePer(state, "point", pclSource()->size());
  state.counters["points"] = static_cast<double>(pclSource()->size());
  state.counters["pairs_per_point"] = static_cast<double>(pairs) / static_cast<double>(pclSource()->size());
}

void alignByPcl(benchmark::State& state) {
  PclNdt& ndt = pclNdt();
  ndt.setSource(pclSource());
  double iterations = 0.0;
  while (state.KeepRunningBatch(saw_ndt::kPerturbedStartCount)) {
    for (int k = 0; k < saw_ndt::kPerturbedStartCount; ++k) {
      iterations += ndt.align(saw_ndt::perturbedStart(saw_ndt::benchmarkPose(), k)).iterations;
    }
  }
  state.counters["pcl_iterations"] = benchmark::Counter(iterations, benchmark::Counter::kAvgIterations);
  state.counters["points"] = static_cast<double>(pclSource()->size());
}

}  // namespace

int main(int argc, char** argv) {
  return saw_ndt::runBenchmarkProgram(argc, argv, [] {
    for (const std::string method : {"classical", "weighted"}) {
      saw_ndt::registerForEachInstructionSet("evaluate/" + method, [method](benchmark::State& state, int threads) {
        evaluate(state, saw_ndt::registrationCase(method), threads);
      });
    }
    benchmark::RegisterBenchmark("pcl/evaluate", evaluateByPcl);
    for (const std::string& method : saw_ndt::LocalizationMethod::names()) {
      saw_ndt::registerForEachInstructionSet("align/" + method, [method](benchmark::State& state, int threads) {
        align(state, saw_ndt::registrationCase(method), threads);
      });
    }
    // Ten alignments that take seconds each are repetition enough.
    benchmark::RegisterBenchmark("pcl/align", alignByPcl)->Repetitions(1);
  });
}
