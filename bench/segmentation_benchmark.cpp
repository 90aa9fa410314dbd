// Segmentation of a scan by ScanSegmenter and its stages.

#include <vector>

#include "benchmark_program.h"
#include "benchmark_scans.h"
#include "common/executor.h"
#include "saw_ndt/pcl/cloud_view.h"
#include "saw_ndt/segmentation/scan_segmenter.h"
#include "segmentation/segmentation_stages.h"

namespace {

/// A scan and what the stages before one make of it.
struct Stages {
  saw_ndt::SegmentationOptions options;
  saw_ndt::ScanView scan = saw_ndt::viewOf(saw_ndt::benchmarkScan());
  saw_ndt::internal::RangeImage image;
  saw_ndt::internal::GroundDetection ground_detection;
  saw_ndt::internal::ComponentFilter component_filter;
  std::vector<std::uint8_t> ground;
  std::vector<saw_ndt::StructuralLabel> labels;

  void project(int threads) {
    image.project(scan, options.sensor, saw_ndt::internal::ScanProjection(options), threads);
  }
  void detectGround() { ground_detection.detect(image, options.sensor, options.ground, ground); }
  void filterComponents(int threads) {
    component_filter.label(image, options.sensor, ground, options.components, labels, threads);
  }
};

void projectScan(benchmark::State& state, int threads) {
  Stages stages;
  const saw_ndt::internal::HelperSession session(threads);  // as a segmentation has
  for (auto _ : state) stages.project(threads);
  saw_ndt::setTimePer(state, "point", stages.scan.size);
}

void detectGround(benchmark::State& state, int threads) {
  Stages stages;
  stages.project(threads);
  for (auto _ : state) stages.detectGround();
  saw_ndt::setTimePer(state, "point", stages.scan.size);
}

void filterComponents(benchmark::State& state, int threads) {
  Stages stages;
  stages.project(threads);
  stages.detectGround();
  const saw_ndt::internal::HelperSession session(threads);  // as a segmentation has
  for (auto _ : state) stages.filterComponents(threads);
  saw_ndt::setTimePer(state, "point", stages.scan.size);
}

void segment(benchmark::State& state, int threads) {
  const saw_ndt::ScanView scan = saw_ndt::viewOf(saw_ndt::benchmarkScan());
  saw_ndt::ScanSegmenter segmenter;
  std::vector<saw_ndt::StructuralLabel> labels;
  for (auto _ : state) segmenter.segment(scan, labels, threads);
  saw_ndt::setTimePer(state, "point", scan.size);
}

}  // namespace

int main(int argc, char** argv) {
  return saw_ndt::runBenchmarkProgram(argc, argv, [] {
    saw_ndt::registerForEachInstructionSet("project", projectScan);
    saw_ndt::registerForEachInstructionSet("ground", detectGround, {1});
    saw_ndt::registerForEachInstructionSet("components", filterComponents);
    saw_ndt::registerForEachInstructionSet("segment", segment);
  });
}
