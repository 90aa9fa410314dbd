#include <gtest/gtest.h>

#include "allocation_counter.h"
#include "saw_ndt/segmentation/scan_segmenter.h"
#include "segmentation/synthetic_scan.h"

namespace saw_ndt {

using namespace internal;

namespace {

TEST(ScanSegmenter, AllocatesNothingInTheSteadyState) {
  const SensorModel sensor = SensorModel::named("HDL-64E");
  const auto smooth =
      ringOrderedScan(sensor, [&](int row, int) { return std::min(25.0, rangeToFlatGround(sensor, row)); });
  const auto rough = ringOrderedScan(sensor, [&](int row, int column) {
    return (row + column) % 17 == 0 ? kNoReturn : 5.0 + (row * 31 + column * 17) % 13;
  });
  for (const int threads : {1, 3}) {
    ScanSegmenter segmenter;
    std::vector<StructuralLabel> labels;
    segmenter.segment(viewOf(smooth), labels, threads);
    const long before = allocation_count;
    for (const auto* scan : {&rough, &smooth, &rough}) segmenter.segment(viewOf(*scan), labels, threads);
    EXPECT_EQ(allocation_count - before, 0) << threads;
  }
}

}  // namespace
}  // namespace saw_ndt
