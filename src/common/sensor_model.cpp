#include "saw_ndt/common/sensor_model.h"

#include <algorithm>
#include <stdexcept>

#include "saw_ndt/common/error.h"

namespace saw_ndt {
namespace {

// Median elevation of each ring's returns beyond 3 m over 100 scans of KITTI. The beams do not leave one point, so the
// elevation at which a ring is seen changes by some tenths of a degree with the range.
const std::vector<double> kHdl64eElevationsDeg = {
    2.45,   2.08,   1.82,   1.36,   1.09,   0.66,   0.39,   0.01,   -0.33,  -0.73,  -1.01,  -1.34,  -1.71,
    -2.05,  -2.36,  -2.70,  -2.98,  -3.35,  -3.61,  -3.97,  -4.27,  -4.59,  -4.92,  -5.24,  -5.60,  -5.91,
    -6.21,  -6.48,  -6.84,  -7.19,  -7.42,  -7.79,  -8.39,  -8.90,  -9.37,  -9.75,  -10.21, -10.81, -11.31,
    -11.73, -12.18, -12.61, -13.13, -13.65, -14.22, -14.66, -15.15, -15.51, -16.12, -16.65, -17.21, -17.66,
    -18.16, -18.57, -19.02, -19.57, -20.07, -20.69, -21.17, -21.59, -22.03, -22.66, -23.17, -23.66};

std::vector<double> evenElevations(int rows, double top_deg, double bottom_deg) {
  std::vector<double> elevations;
  for (int row = 0; row < rows; ++row) {
    const double share = rows > 1 ? static_cast<double>(row) / (rows - 1) : 0.0;
    elevations.push_back(top_deg + share * (bottom_deg - top_deg));
  }
  return elevations;
}

const std::vector<SensorModel>& knownModels() {
  static const std::vector<SensorModel> models = {
      {"HDL-64E", 1800, kHdl64eElevationsDeg},
      {"HDL-32E", 1800, evenElevations(32, 10.67, -30.67)},
      {"VLP-16", 1800, evenElevations(16, 15.0, -15.0)},
      {"OS-64", 1024, evenElevations(64, 22.5, -22.5)},
      {"OS-128", 1024, evenElevations(128, 22.5, -22.5)},
  };
  return models;
}

}  // namespace

void SensorModel::check() const {
  // Files that name the sensor have it in a line.
  checkOption(std::all_of(name.begin(), name.end(), [](char c) { return static_cast<unsigned char>(c) >= ' '; }),
              "name", name, "without line breaks and other control characters");
  checkOption(rows() <= 1024, "elevations_deg.size()", rows(), "at most 1024");
  checkOption(columns >= 8 && columns <= 16384, "columns", columns, "8 to 16384");
  for (int row = 0; row < rows(); ++row) {
    const double elevation = elevations_deg[row];
    checkOption(elevation > -90.0 && elevation < 90.0, "elevations_deg", elevation, "between -90 and 90");
    checkOption(row == 0 || elevation < elevations_deg[row - 1], "elevations_deg", elevation,
                "below the elevation of the row above it");
  }
}

SensorModel SensorModel::named(const std::string& name) {
  for (const SensorModel& model : knownModels()) {
    if (model.name == name) return model;
  }
  std::string known;
  for (const std::string& candidate : names()) known += (known.empty() ? "" : ", ") + candidate;
  throw std::invalid_argument("sensor model \"" + name + "\": must be one of " + known);
}

std::vector<std::string> SensorModel::names() {
  std::vector<std::string> result;
  for (const SensorModel& model : knownModels()) result.push_back(model.name);
  return result;
}

SensorModel SensorModel::evenlySpaced(const std::string& name, int rows, int columns, double top_deg,
                                      double bottom_deg) {
  SensorModel model{name, columns, evenElevations(rows, top_deg, bottom_deg)};
  model.check();
  return model;
}

}  // namespace saw_ndt
