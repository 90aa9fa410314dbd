#include "io/kitti_calibration.h"

#include <algorithm>
#include <string>
#include <utility>

#include "io/number_lines.h"
#include "io/rigid_transform.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

namespace {

/// The first word of a line, and what follows it and a colon behind it.
std::pair<std::string_view, std::string_view> splitAtKey(std::string_view line) {
  constexpr std::string_view kBlanks = " \t";
  line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
  const std::string_view key = line.substr(0, line.find_first_of(" \t:"));
  line.remove_prefix(key.size());
  line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
  if (!line.empty() && line.front() == ':') line.remove_prefix(1);
  return {key, line};
}

/// The rotation whose matrix is given row by row.
Eigen::Isometry3d rotation(const std::filesystem::path& path, std::size_t line, const std::vector<double>& values) {
  if (values.size() != 9) {
    throw Error(path.string(), linePlace(line), std::to_string(values.size()) + " numbers, where 9 are needed");
  }
  std::vector<double> transform;
  for (std::size_t i = 0; i < 9; ++i) {
    transform.push_back(values[i]);
    if (i % 3 == 2) transform.push_back(0.0);
  }
  return rigidTransform(path, line, transform);
}

}  // namespace

NumberLine kittiNumbers(const std::filesystem::path& path, const std::vector<std::string_view>& keys) {
  NumberLine found{0, {}};
  for (const TextLine& line : readTextLines(path)) {
    const auto [key, rest] = splitAtKey(line.text);
    if (std::find(keys.begin(), keys.end(), key) == keys.end()) continue;
    found = {line.number, parseNumbers(path, line.number, rest)};
  }
  return found;
}

std::optional<Eigen::Isometry3d> kittiTransform(const std::filesystem::path& path,
                                                const std::vector<std::string_view>& keys) {
  const NumberLine line = kittiNumbers(path, keys);
  if (line.number == 0) return std::nullopt;
  return rigidTransform(path, line.number, line.values);
}

std::optional<Eigen::Isometry3d> kittiRotation(const std::filesystem::path& path,
                                               const std::vector<std::string_view>& keys) {
  const NumberLine line = kittiNumbers(path, keys);
  if (line.number == 0) return std::nullopt;
  return rotation(path, line.number, line.values);
}

}  // namespace saw_ndt::internal
