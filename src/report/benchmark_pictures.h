#pragma once

#include <vector>

#include "report/benchmark.h"
#include "report/gnuplot.h"

namespace saw_ndt {

/// The pictures of a run: mapPicture(), then position error, yaw error and likelihood along the way, and the
/// distribution of run times.
std::vector<GnuplotPicture> benchmarkPictures(const BenchmarkRun& run);

}  // namespace saw_ndt
