#pragma once

#include <fuzzer/FuzzedDataProvider.h>

#include <Eigen/Geometry>
#include <vector>

#include "saw_ndt/common/labels.h"
#include "saw_ndt/common/scan_view.h"
#include "saw_ndt/registration/source_points.h"

namespace saw_ndt {

/// A number that is any of its kind: ordinary, or not finite, huge, subnormal.
float anyFloat(FuzzedDataProvider& provider, float scale);

/// Points anywhere, upon a street or alone, in rows or not, with rings and times or without.
ScanPoints anyScan(FuzzedDataProvider& provider);

/// A label for each point.
std::vector<StructuralLabel> anyLabels(FuzzedDataProvider& provider, std::size_t count);

/// A rigid transform within `reach_m` along each axis; or, once in a while, one that is none.
Eigen::Isometry3d anyPose(FuzzedDataProvider& provider, double reach_m);

/// The finite points of a scan, with labels or without.
SourcePoints anySource(FuzzedDataProvider& provider);

}  // namespace saw_ndt
