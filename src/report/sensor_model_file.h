#pragma once

#include <filesystem>
#include <string>

#include "saw_ndt/common/sensor_model.h"

namespace saw_ndt {

/// Reads a sensor model: JSON with `//` comments, like the files of data/sensors. Its members are `name`, `columns` and
/// `elevations_deg`, as in SensorModel, and, for its readers alone, `other_names` and `source`.
/// @throws Error that names file, member and reason, for what is no such file: members that are unknown or, of the
/// first three, missing, and whatever SensorModel::check() refuses
SensorModel readSensorModel(const std::filesystem::path& path);

/// What `-sensor` of an app names: the model in the file where the text ends in ".json", otherwise
/// SensorModel::named().
SensorModel sensorModelOf(const std::string& name_or_file);

}  // namespace saw_ndt
