#pragma once

#include <vector>

#include "report/evaluation_report.h"
#include "report/gnuplot.h"

namespace saw_ndt {

/// The pictures of an evaluation: `trajectories` from above, the estimate coloured by its position error,
/// `position_error` and `yaw_error` over time, and `relative_error_frames` and `relative_error_metres` where those are
/// known.
std::vector<GnuplotPicture> evaluationPictures(const TrajectoryEvaluation& evaluation);

}  // namespace saw_ndt
