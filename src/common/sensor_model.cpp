#include "saw_ndt/common/sensor_model.h"

#include <algorithm>
#include <stdexcept>

#include "common/sensor_tables.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt {
void SensorModel::check() const {
  // Files that name the sensor have it in a line.
  checkOption(std::all_of(name.begin(), name.end(), [](char c) { return static_cast<unsigned char>(c) >= ' '; }),
              "name", name, "without line breaks and other control characters");
  checkOption(rows() <= 1024, "elevations_deg.size()", rows(), "0 to 1024");
  checkOption(columns >= 8 && columns <= 16384, "columns", columns, "8 to 16384");
  for (int row = 0; row < rows(); ++row) {
    const double elevation = elevations_deg[row];
    checkOption(elevation > -90.0 && elevation < 90.0, "elevations_deg", elevation, "between -90 and 90");
    checkOption(row == 0 || elevation < elevations_deg[row - 1], "elevations_deg", elevation,
                "below the elevation of the row above it");
  }
}

SensorModel SensorModel::named(const std::string& name) {
  for (const SensorModel& model : internal::sensorTables()) {
    if (model.name == name) return model;
  }
  std::string known;
  for (const std::string& candidate : names()) known += (known.empty() ? "" : ", ") + candidate;
  throw std::invalid_argument("sensor model \"" + name + "\": must be one of " + known);
}

std::vector<std::string> SensorModel::names() {
  std::vector<std::string> result;
  for (const SensorModel& model : internal::sensorTables()) result.push_back(model.name);
  return result;
}

SensorModel SensorModel::evenlySpaced(const std::string& name, int rows, int columns, double top_deg,
                                      double bottom_deg) {
  checkOption(rows >= 1, "rows", rows, "1 or more");
  SensorModel model{name, columns, {}};
  for (int row = 0; row < rows; ++row) {
    const double share = rows > 1 ? static_cast<double>(row) / (rows - 1) : 0.0;
    model.elevations_deg.push_back(top_deg + share * (bottom_deg - top_deg));
  }
  model.check();
  return model;
}

}  // namespace saw_ndt
