// How long a target takes from raw points to voxels, beside pcl::NormalDistributionsTransform, stage by stage, and how
// long map files take.
//
//   setInputTarget    2,000,000 points of consecutive scans in the map frame, coarse level included
//   add_cloud         the points into sums
//   build             the sums into a map and its target: sorted, both levels and their indices
//   fine, coarse      one level with its index
//   index             the index of the fine level
//   save, load        a synthetic map of 200,000 voxels; loading is to both levels

#include <pcl/registration/ndt.h>
#include <unistd.h>

#include <filesystem>
#include <random>

#include "benchmark_program.h"
#include "benchmark_scans.h"
#include "map/coarse_sums.h"
#include "map/ndt_level.h"
#include "saw_ndt/map/ndt_target.h"
#include "saw_ndt/map/weighted_map_builder.h"
#include "saw_ndt/pcl/cloud_view.h"
#include "saw_ndt/pcl/weighted_normal_distributions_transform.h"

namespace saw_ndt {

using namespace internal;

namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

constexpr std::size_t kTargetPoints = 2000000;
constexpr std::size_t kFileVoxels = 200000;

const Cloud::Ptr& target() {
  static const Cloud::Ptr cloud = benchmarkTarget(kTargetPoints);
  return cloud;
}

const WeightedMapBuilder& targetBuilder() {
  static const WeightedMapBuilder builder = [] {
    WeightedMapBuilder filled(1.0);
    addCloud(filled, *target(), Eigen::Isometry3d::Identity());
    return filled;
  }();
  return builder;
}

const WeightedVoxelMap& targetMap() {
  static const WeightedVoxelMap map = targetBuilder().build();
  return map;
}

// Voxels of a rolling plain, ten points each.
const WeightedVoxelMap& fileMap() {
  static const WeightedVoxelMap map = [] {
    std::mt19937 random(1);
    std::uniform_int_distribution<std::int32_t> steps(-kStepsPerVoxel / 2, kStepsPerVoxel / 2);
    std::vector<LabelledVoxelSums> entries;
    const int width = 500;
    for (std::size_t i = 0; i < kFileVoxels; ++i) {
      const int x = static_cast<int>(i) % width, y = static_cast<int>(i) / width;
      entries.push_back({{x, y, (x + y) / 32}, StructuralLabel::NON_GROUND, {}});
      for (int point = 0; point < 10; ++point) {
        entries.back().sums.add({steps(random), steps(random), steps(random)});
      }
    }
    MapOrigin origin;
    origin.scan_count = 1;
    origin.point_count = 10 * kFileVoxels;
    return WeightedVoxelMap(origin, std::move(entries));
  }();
  return map;
}

// The file of fileMap(), which goes with this object.
class MapFile {
 public:
  MapFile()
      : path_(std::filesystem::temp_directory_path() / ("saw_ndt_benchmark_" + std::to_string(getpid()) + ".map")) {
    fileMap().save(path_.string());
  }
  ~MapFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  MapFile(const MapFile&) = delete;
  MapFile& operator=(const MapFile&) = delete;

  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

void setInputTarget(benchmark::State& state, int threads) {
  WeightedNormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ> ndt;
  ndt.setNumberOfThreads(static_cast<unsigned int>(threads));
  for (auto _ : state) ndt.setInputTarget(target());
  setTimePer(state, "point", target()->size());
}

void setInputTargetOfPcl(benchmark::State& state) {
  pcl::NormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ> ndt;
  for (auto _ : state) ndt.setInputTarget(target());
  setTimePer(state, "point", target()->size());
}

void addCloud(benchmark::State& state, const Eigen::Isometry3d& T_map_cloud, int threads) {
  for (auto _ : state) {
    WeightedMapBuilder builder(1.0);
    addCloud(builder, *target(), T_map_cloud, threads);
    benchmark::DoNotOptimize(builder);
  }
  setTimePer(state, "point", target()->size());
}

void build(benchmark::State& state, int threads) {
  for (auto _ : state) benchmark::DoNotOptimize(NdtTarget(targetBuilder().build(), {}, threads));
  setTimePer(state, "entry", targetMap().entries().size());
}

void level(benchmark::State& state, int factor, int threads) {
  const std::vector<LabelledVoxelSums>& entries = targetMap().entries();
  const double resolution_m = targetMap().resolution(), step_m = resolution_m / kStepsPerVoxel;
  std::size_t voxels = 0;
  for (auto _ : state) {
    if (factor == 1) {
      voxels =
          internal::NdtLevel::fromSums(entries, {1, resolution_m}, {}, step_m, CellPrecision::SINGLE, threads).size();
    } else {
      internal::CoarseSums sums(factor);
      sums.add(entries.data(), entries.data() + entries.size());
      voxels = internal::NdtLevel::fromSums(sums.takeInMapOrder(), {factor, factor * resolution_m}, {}, step_m,
                                            CellPrecision::SINGLE, threads)
                   .size();
    }
  }
  setTimePer(state, "voxel", voxels);
}

void index(benchmark::State& state) {
  const std::vector<VoxelCoordinate> voxels = NdtTarget(targetMap()).fine().index().voxels();
  for (auto _ : state) benchmark::DoNotOptimize(internal::VoxelIndex(voxels));
  setTimePer(state, "voxel", voxels.size());
}

void save(benchmark::State& state) {
  const MapFile file;
  for (auto _ : state) fileMap().save(file.path());
  setTimePer(state, "entry", kFileVoxels);
}

void load(benchmark::State& state, int threads) {
  const MapFile file;
  for (auto _ : state) benchmark::DoNotOptimize(NdtTarget::load(file.path(), {}, threads));
  setTimePer(state, "entry", kFileVoxels);
}

void registerBenchmarks() {
  // What is made at first use shall not be timed.
  targetMap();
  fileMap();
  benchmark::RegisterBenchmark("pcl/setInputTarget", setInputTargetOfPcl);
  registerForEachInstructionSet("setInputTarget", setInputTarget);
  registerForEachInstructionSet("add_cloud", [](benchmark::State& state, int threads) {
    addCloud(state, Eigen::Isometry3d::Identity(), threads);
  });
  registerForEachInstructionSet("add_cloud/posed",
                                [](benchmark::State& state, int threads) {
                                  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
                                  T.rotate(Eigen::AngleAxisd(0.3, Eigen::Vector3d(0.1, 0.2, 1.0).normalized()));
                                  addCloud(state, T, threads);
                                },
                                {1});
  registerForEachInstructionSet("build", build);
  registerForEachInstructionSet("fine", [](benchmark::State& state, int threads) { level(state, 1, threads); });
  registerForEachInstructionSet("coarse", [](benchmark::State& state, int threads) { level(state, 3, threads); });
  registerForEachInstructionSet("index", [](benchmark::State& state, int /*threads*/) { index(state); }, {1});
  registerForEachInstructionSet("save", [](benchmark::State& state, int /*threads*/) { save(state); }, {1});
  registerForEachInstructionSet("load", load);
}

}  // namespace
}  // namespace saw_ndt

int main(int argc, char** argv) { return saw_ndt::runBenchmarkProgram(argc, argv, saw_ndt::registerBenchmarks); }
