#include "report/evaluation_report.h"

#include <algorithm>
#include <cstddef>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <ostream>
#include <sstream>
#include <string>
#include <utility>

#include "report/json.h"

namespace saw_ndt {

namespace {

constexpr int kNameWidth = 26;

std::optional<RelativeEvaluation> evaluatedRelatively(const std::vector<PosePair>& pairs,
                                                      const std::optional<RelativeErrorOptions>& options) {
  if (!options) return std::nullopt;
  return RelativeEvaluation{*options, relativePoseErrors(pairs, *options)};
}

nlohmann::ordered_json toJson(const RelativeEvaluation& relative) {
  nlohmann::ordered_json json;
  const bool by_metres = relative.options.unit == RelativeErrorOptions::Unit::METRES;
  json["delta"] = relative.options.delta;
  if (!by_metres) json["delta"] = static_cast<std::size_t>(relative.options.delta);
  json["all_pairs"] = relative.options.all_pairs;
  if (by_metres) {
    json["way_of"] = relative.options.way_of_reference ? "reference" : "estimate";
  }
  json["pairs"] = relative.errors.size();
  json.update(toJson(statisticsOf(relative.errors), ""));
  return json;
}

bool holdsObjects(const nlohmann::ordered_json& object) {
  return std::any_of(object.begin(), object.end(), [](const nlohmann::ordered_json& v) { return v.is_structured(); });
}

std::string statisticsLine(const nlohmann::ordered_json& statistics) {
  std::ostringstream line;
  line << std::setprecision(6);
  for (const auto& [name, value] : statistics.items()) {
    line << (line.tellp() > 0 ? "  " : "") << name << ' ' << value.get<double>();
  }
  return line.str();
}

void writeMembers(const nlohmann::ordered_json& object, const std::string& prefix, std::ostream& stream) {
  for (const auto& [name, value] : object.items()) {
    if (value.is_object() && holdsObjects(value)) {
      writeMembers(value, prefix + name + '.', stream);
      continue;
    }
    stream << std::left << std::setw(kNameWidth) << prefix + name;
    if (value.is_object()) {
      stream << statisticsLine(value) << '\n';
    } else if (value.is_string()) {
      stream << value.get<std::string>() << '\n';
    } else {
      stream << value << '\n';
    }
  }
}

}  // namespace

TrajectoryEvaluation evaluated(PairedTrajectories paired, const PairingOptions& pairing, TrajectoryAlignment alignment,
                               const std::optional<RelativeErrorOptions>& by_frames,
                               const std::optional<RelativeErrorOptions>& by_metres) {
  TrajectoryEvaluation evaluation;
  evaluation.T_reference_estimate = alignmentTransform(paired.pairs, alignment);
  paired.pairs = alignedPairs(std::move(paired.pairs), alignment);
  evaluation.paired = std::move(paired);
  evaluation.pairing = pairing;
  evaluation.alignment = alignment;
  evaluation.by_frames = evaluatedRelatively(evaluation.paired.pairs, by_frames);
  evaluation.by_metres = evaluatedRelatively(evaluation.paired.pairs, by_metres);
  return evaluation;
}

nlohmann::ordered_json toJson(const TrajectoryEvaluation& evaluation) {
  const PairedTrajectories& paired = evaluation.paired;
  nlohmann::ordered_json json = toJson(evaluatePosePairs(paired.pairs));
  if (const auto kitti = kittiRelativeErrors(paired.pairs)) json.update(toJson(*kitti));
  json["estimate_poses"] = paired.estimate_poses;
  json["reference_poses"] = paired.reference_poses;
  json["paired_share"] = paired.pairedShare();
  json["interpolated"] = evaluation.pairing.interpolate;
  json["align"] = toString(evaluation.alignment);
  if (evaluation.alignment != TrajectoryAlignment::NONE) {
    const Vector6d xyz_rpy = xyzRpyFromTransform(evaluation.T_reference_estimate);
    json["align_transform"] = {{"x_m", xyz_rpy(0)},
                               {"y_m", xyz_rpy(1)},
                               {"z_m", xyz_rpy(2)},
                               {"roll_deg", degreesFromRadians(xyz_rpy(3))},
                               {"pitch_deg", degreesFromRadians(xyz_rpy(4))},
                               {"yaw_deg", degreesFromRadians(xyz_rpy(5))}};
  }
  json.update(toJson(absolutePoseErrors(paired.pairs), "ape_"));
  if (evaluation.by_frames) json["rpe_frames"] = toJson(*evaluation.by_frames);
  if (evaluation.by_metres) json["rpe_metres"] = toJson(*evaluation.by_metres);
  return json;
}

void writeText(const nlohmann::ordered_json& report, std::ostream& stream) { writeMembers(report, "", stream); }

}  // namespace saw_ndt
