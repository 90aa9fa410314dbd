#pragma once

#include "report/benchmark.h"
#include "report/gnuplot.h"

namespace saw_ndt {

/// The map of a run seen from above, ground and the rest in colours of their own, with the reference, the trajectory of
/// each method and the scans that were rejected. Both axes have one scale.
GnuplotPicture mapPicture(const BenchmarkRun& run);

}  // namespace saw_ndt
