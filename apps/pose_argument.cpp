#include "pose_argument.h"

#include <cmath>
#include <sstream>

#include "app_options.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt {

Eigen::Isometry3d transformOf(const std::vector<double>& xyz_rpy_deg) {
  Vector6d values;
  for (int i = 0; i < 6; ++i) {
    const double value = xyz_rpy_deg.at(static_cast<std::size_t>(i));
    values[i] = i < 3 ? value : radiansFromDegrees(value);
  }
  return transformFromXyzRpy(values);
}

Eigen::Isometry3d transformOf(const std::string& text, const std::string& option) {
  std::vector<double> values;
  std::istringstream stream(text);
  bool all_numbers = true;
  for (std::string word; std::getline(stream, word, ',');) {
    std::istringstream number(word);
    double value = 0.0;
    all_numbers = all_numbers && number >> value && (number >> std::ws).eof() && std::isfinite(value);
    values.push_back(value);
  }
  if (!all_numbers || values.size() != 6) {
    throw UsageError("option " + option + ": '" + text + "' is not " + kPosePlaceholder);
  }
  return transformOf(values);
}

std::vector<double> poseArgumentOf(const Eigen::Isometry3d& T) {
  const Vector6d values = xyzRpyFromTransform(T);
  std::vector<double> xyz_rpy_deg(values.data(), values.data() + 6);
  for (std::size_t i = 3; i < 6; ++i) xyz_rpy_deg[i] = degreesFromRadians(xyz_rpy_deg[i]);
  return xyz_rpy_deg;
}

}  // namespace saw_ndt
