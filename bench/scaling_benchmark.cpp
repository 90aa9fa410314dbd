// How an evaluation and an alignment grow with the source and with the map, in a synthetic city: in proportion to the
// points, and not at all with the map around them.

#include <map>
#include <utility>

#include "benchmark_program.h"
#include "common/executor.h"
#include "registration/ndt_evaluation.h"
#include "saw_ndt/registration/ndt_aligner.h"
#include "synthetic_city.h"

namespace {

using Source = saw_ndt::SourcePoints (*)(std::size_t point_count);

constexpr std::size_t kPoints = 16384;       // where the map grows
constexpr std::size_t kMapVoxels = 100000;   // where the source grows
constexpr std::size_t kBlockVoxels = 10000;  // a map that holds all that a scan sees
constexpr std::size_t kMostVoxels = 10000000;

const saw_ndt::NdtTarget& targetOf(std::size_t voxel_count) {
  static std::map<std::size_t, saw_ndt::NdtTarget> targets;
  const auto found = targets.find(voxel_count);
  return found != targets.end() ? found->second
                                : targets.emplace(voxel_count, saw_ndt::cityTarget(voxel_count)).first->second;
}

saw_ndt::AlignmentOptions optionsFor(int threads) {
  saw_ndt::AlignmentOptions options;
  options.threads = threads;
  return options;
}

void evaluate(benchmark::State& state, const saw_ndt::SourcePoints& source, std::size_t map_voxels, int threads) {
  const saw_ndt::NdtTarget& target = targetOf(map_voxels);
  const Eigen::Isometry3d T_map_source(Eigen::Translation3d(0.03, 0.02, 0.01));
  const saw_ndt::AlignmentOptions options = optionsFor(threads);
  saw_ndt::internal::NdtEvaluation ordered;
  ordered.begin(target, source, options);
  const saw_ndt::internal::Evaluation evaluation = ordered.onMatchingLevels(T_map_source);
  saw_ndt::internal::NdtDerivatives derivatives;
  const saw_ndt::internal::HelperSession session(threads);  // as an alignment has
  for (auto _ : state) {
    derivatives = evaluation(T_map_source);
    benchmark::DoNotOptimize(derivatives);
  }
  saw_ndt::setTimePer(state, "pair", derivatives.pair_count);
  saw_ndt::setTimePer(state, "point", source.size());
  state.counters["pairs_per_point"] = static_cast<double>(derivatives.pair_count) / static_cast<double>(source.size());
}

void align(benchmark::State& state, const saw_ndt::SourcePoints& source, std::size_t map_voxels, int threads) {
  const saw_ndt::NdtTarget& target = targetOf(map_voxels);
  const Eigen::Isometry3d T_start =
      Eigen::Translation3d(0.3, 0.2, 0.05) * Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitZ());
  saw_ndt::NdtAligner aligner;
  double evaluations = 0.0;
  for (auto _ : state) evaluations += aligner.align(target, source, T_start, optionsFor(threads)).evaluations;
  saw_ndt::setTimePer(state, "point", source.size());
  state.counters["evaluations"] = benchmark::Counter(evaluations, benchmark::Counter::kAvgIterations);
}

using Benchmark = void (*)(benchmark::State&, const saw_ndt::SourcePoints&, std::size_t map_voxels, int threads);

// By one thread with the best instructions.
void add(const std::string& stage_and_size, Benchmark run, Source make, std::size_t points, std::size_t map_voxels) {
  const std::string name =
      stage_and_size + "/" + saw_ndt::internal::toString(saw_ndt::internal::instructionSet()) + "/threads:1";
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) { run(state, make(points), map_voxels, 1); });
}

void addAll() {
  for (const auto& [stage, run] : {std::pair<std::string, Benchmark>("evaluate", evaluate), {"align", align}}) {
    for (std::size_t points = 1024; points <= 131072; points *= 2) {
      add(stage + "/points:" + std::to_string(points), run, saw_ndt::cityScan, points, kMapVoxels);
    }
  }
  // A source that the smallest map holds, then one that spreads over a city block.
  for (std::size_t voxels = 10; voxels <= kMostVoxels; voxels *= 10) {
    add("evaluate_patch/map_voxels:" + std::to_string(voxels), evaluate, saw_ndt::cityPatch, kPoints, voxels);
  }
  for (const auto& [stage, run] : {std::pair<std::string, Benchmark>("evaluate", evaluate), {"align", align}}) {
    for (std::size_t voxels = kBlockVoxels; voxels <= kMostVoxels; voxels *= 10) {
      add(stage + "/map_voxels:" + std::to_string(voxels), run, saw_ndt::cityScan, kPoints, voxels);
    }
  }
}

}  // namespace

int main(int argc, char** argv) { return saw_ndt::runSyntheticBenchmarkProgram(argc, argv, addAll); }
