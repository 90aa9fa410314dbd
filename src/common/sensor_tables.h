#pragma once

#include <vector>

#include "saw_ndt/common/sensor_model.h"

namespace saw_ndt::internal {

/// The models that data/sensors states, one for each of their names.
const std::vector<SensorModel>& sensorTables();

}  // namespace saw_ndt::internal
