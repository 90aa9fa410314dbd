#include "alignment_report.h"

#include <array>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "pose_argument.h"

namespace saw_ndt {
namespace {

using Json = nlohmann::ordered_json;

Json figuresOf(const AlignmentReport& report) {
  constexpr std::array<const char*, 6> kPoseNames{"x_m", "y_m", "z_m", "roll_deg", "pitch_deg", "yaw_deg"};
  const std::vector<double> pose = poseArgumentOf(report.result.T_map_source);
  Json json;
  for (std::size_t i = 0; i < kPoseNames.size(); ++i) json[kPoseNames[i]] = pose[i];
  json["converged"] = report.result.converged();
  json["iterations"] = report.result.iterations;
  json["evaluations"] = report.result.evaluations;
  json["likelihood"] = report.result.likelihood;
  json["overlap"] = report.result.overlap;
  json["degenerate"] = freeAxes(report.result.free_directions, report.result.T_map_source.linear());
  const Vector6d sigma = standardDeviations(report.result.covariance, report.result.T_map_source.linear());
  for (int i = 0; i < 6; ++i) {
    json["sigma_" + std::string(kPoseNames[static_cast<std::size_t>(i)])] =
        i < 3 ? sigma[i] : degreesFromRadians(sigma[i]);
  }
  if (report.fitness_m2) json["fitness_m2"] = *report.fitness_m2;
  json["weighted"] = report.weighted;
  json["source_points"] = report.source_points;
  json["target_voxels"] = report.target_voxels;
  return json;
}

}  // namespace

std::string toText(const AlignmentReport& report) {
  const Eigen::IOFormat rows(12, 0, " ", "\n");
  std::ostringstream text;
  text << report.result.T_map_source.matrix().format(rows) << '\n';
  const Json figures = figuresOf(report);
  for (const auto& [name, value] : figures.items()) {
    text << std::left << std::setw(16) << name << value.dump() << '\n';
  }
  return text.str();
}

std::string toJsonText(const AlignmentReport& report) {
  Json rows = Json::array();
  for (int row = 0; row < 4; ++row) {
    Json values = Json::array();
    for (int column = 0; column < 4; ++column) values.push_back(report.result.T_map_source(row, column));
    rows.push_back(values);
  }
  Json json{{"T_target_source", rows}};
  json.update(figuresOf(report));
  return json.dump(2) + "\n";
}

}  // namespace saw_ndt
