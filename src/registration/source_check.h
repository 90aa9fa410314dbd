#pragma once

#include "saw_ndt/registration/source_points.h"

namespace saw_ndt::internal {

/// Throws std::invalid_argument that tells what is wrong unless each point of a source is within reach and has a label.
void requireRegistrable(const SourcePoints& source);

}  // namespace saw_ndt::internal
