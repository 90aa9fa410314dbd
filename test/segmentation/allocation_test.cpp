#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "saw_ndt/segmentation/ground_subsampling.h"
#include "saw_ndt/segmentation/scan_segmenter.h"
#include "segmentation/synthetic_scan.h"

namespace {
std::atomic<long> allocations{0};
}

// Replaces the operators of this whole program: what is counted is what the library asks for.
void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace saw_ndt {
namespace {

TEST(ScanSegmenter, AllocatesNothingInTheSteadyState) {
  const SensorModel sensor = SensorModel::named("HDL-64E");
  const auto smooth =
      ringOrderedScan(sensor, [&](int row, int) { return std::min(25.0, rangeToFlatGround(sensor, row)); });
  const auto rough = ringOrderedScan(sensor, [&](int row, int column) {
    return (row + column) % 17 == 0 ? kNoReturn : 5.0 + (row * 31 + column * 17) % 13;
  });
  ScanSegmenter segmenter;
  std::vector<StructuralLabel> labels;
  pcl::Indices kept;
  segmenter.segment(viewOf(smooth), labels);
  subsampleGround(labels, {1.0}, kept);
  const long before = allocations;
  for (const auto* scan : {&rough, &smooth, &rough}) {
    segmenter.segment(viewOf(*scan), labels);
    subsampleGround(labels, {0.5}, kept);
  }
  EXPECT_EQ(allocations - before, 0);
}

}  // namespace
}  // namespace saw_ndt
