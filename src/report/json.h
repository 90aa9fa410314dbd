#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "evaluation/statistics.h"
#include "report/localization_summary.h"
#include "saw_ndt/evaluation/metrics.h"
#include "saw_ndt/evaluation/pose_errors.h"
#include "saw_ndt/evaluation/relative_errors.h"

// The one public header that needs nlohmann-json; the library's others do without.
namespace saw_ndt {

/// An object with a member for each field, of the field's name.
nlohmann::ordered_json toJson(const TrajectoryMetrics& metrics);

/// {"kitti_segments", "kitti_translation_percent", "kitti_rotation_deg_per_m"}
nlohmann::ordered_json toJson(const KittiRelativeErrors& errors);

/// {"rmse", "mean", "median", "std", "min", "max", "sse"}
nlohmann::ordered_json toJson(const ErrorStatistics& statistics);

/// {"PREFIXtranslation_m", "PREFIXrotation_deg", "PREFIXfull"}, statistics each
nlohmann::ordered_json toJson(const PoseErrorStatistics& statistics, const std::string& prefix);

/// {"mean", "p50", "p95", "max"}
nlohmann::ordered_json toJson(const internal::DurationStatistics& durations);

/// {"scans", "seconds"}
nlohmann::ordered_json toJson(const StateShare& share);

/// The object that is summary.json; the errors are members of it where they are known.
nlohmann::ordered_json toJson(const LocalizationSummary& summary);

}  // namespace saw_ndt
