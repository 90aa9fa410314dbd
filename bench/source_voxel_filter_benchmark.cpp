// Selection and voxel filter of a source by SourceVoxelFilter, beside PCL's VoxelGrid.

#include <pcl/filters/voxel_grid.h>

#include <vector>

#include "benchmark_program.h"
#include "benchmark_scans.h"
#include "localization/source_voxel_filter.h"
#include "saw_ndt/localization/localizer.h"
#include "saw_ndt/pcl/cloud_view.h"
#include "saw_ndt/segmentation/scan_segmenter.h"

namespace {

double voxelSize() { return saw_ndt::LocalizerOptions().source_voxel_size_m; }

void filterSource(benchmark::State& state, const saw_ndt::LocalizationMethod& method) {
  const saw_ndt::ScanView scan = saw_ndt::viewOf(saw_ndt::benchmarkScan());
  std::vector<saw_ndt::StructuralLabel> labels;
  if (method.segment) saw_ndt::ScanSegmenter().segment(scan, labels);
  saw_ndt::internal::SourceVoxelFilter filter(voxelSize());
  const saw_ndt::internal::SourceSelection selection = {method.ground_ratio, method.voxels.confidence,
                                                        Eigen::Isometry3d::Identity()};
  std::size_t centroids = 0;
  for (auto _ : state) centroids = filter.filter(scan, method.segment ? &labels : nullptr, selection).size();
  state.counters["centroids"] = static_cast<double>(centroids);
  saw_ndt::setTimePer(state, "point", scan.size);
}

void filterByPcl(benchmark::State& state) {
  const auto scan = saw_ndt::benchmarkScanPoints();
  const auto size = static_cast<float>(voxelSize());
  pcl::VoxelGrid<pcl::PointXYZ> grid;
  grid.setLeafSize(size, size, size);
  grid.setInputCloud(scan);
  pcl::PointCloud<pcl::PointXYZ> centroids;
  for (auto _ : state) grid.filter(centroids);
  state.counters["centroids"] = static_cast<double>(centroids.size());
  saw_ndt::setTimePer(state, "point", scan->size());
}

}  // namespace

int main(int argc, char** argv) {
  return saw_ndt::runBenchmarkProgram(argc, argv, [] {
    benchmark::RegisterBenchmark("pcl/filter", filterByPcl);
    for (const char* name : {"weighted", "weighted-s50", "classical"}) {
      const saw_ndt::LocalizationMethod method = saw_ndt::LocalizationMethod::named(name);
      const std::vector<int> one_thread = {1};
      saw_ndt::registerForEachInstructionSet(
          std::string("filter/") + name, [=](benchmark::State& state, int) { filterSource(state, method); },
          one_thread);
    }
  });
}
