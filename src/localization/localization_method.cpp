#include "saw_ndt/localization/localization_method.h"

#include <algorithm>
#include <stdexcept>

#include "saw_ndt/common/error.h"

namespace saw_ndt {
namespace {

/// The paper's voxels.
VoxelWeighting voxelsOfOneMetre(const ConfidenceOptions& confidence) {
  VoxelWeighting voxels;
  voxels.confidence = confidence;
  voxels.sizes.finest_m = 1.0;
  return voxels;
}

/// Those of `weighted`: as small as a place bears, and flat surfaces as thin as a LiDAR sees them. PCL's floor makes a
/// plane that fills a voxel of 1 m at least 3 cm thick, and costs a quarter of the accuracy.
VoxelWeighting adaptiveVoxels() {
  VoxelWeighting voxels;
  voxels.confidence.ground = 0.8;
  voxels.min_eigenvalue_ratio = 0.003;
  voxels.unbounded_ground = true;
  voxels.sizes.finest_m = 0.5;
  voxels.sizes.coarsest_m = 4.0;
  voxels.coarse_factor = 6;
  return voxels;
}

const std::vector<LocalizationMethod>& methods() {
  const VoxelWeighting paper = voxelsOfOneMetre(ConfidenceOptions::paper());
  static const std::vector<LocalizationMethod> all = {
      {"weighted", true, 0.5, true, adaptiveVoxels(), 0.5, 0.35, 0.06, true, 1.0},
      {"weighted-s50", true, 0.5, true, paper, 0.1, 0.55, 0.02, false, 4.0},
      {"weighted-s100", true, 1.0, true, paper, 0.1, 0.55, 0.02, false, 4.0},
      {"unweighted-s50", true, 0.5, false, paper, 0.1, 0.55, 0.02, false, 4.0},
      {"classical", false, 1.0, false, voxelsOfOneMetre(ConfidenceOptions::uniform()), 0.1, 0.55, 0.02, false, 4.0},
  };
  return all;
}

}  // namespace

void LocalizationMethod::check() const {
  checkOption(ground_ratio >= 0.0 && ground_ratio <= 1.0, "ground_ratio", ground_ratio, "between 0 and 1");
  checkOption(mismatch_penalty >= 0.0 && mismatch_penalty <= 1.0, "mismatch_penalty", mismatch_penalty,
              "between 0 and 1");
  checkOption(outlier_ratio > 0.0 && outlier_ratio < 1.0, "outlier_ratio", outlier_ratio, "between 0 and 1, exclusive");
  checkOption(coarse_settled_voxels > 0.0, "coarse_settled_voxels", coarse_settled_voxels, "positive");
  checkOption(covariance_scale > 0.0, "covariance_scale", covariance_scale, "positive");
  voxels.check();
}

const std::vector<std::string>& LocalizationMethod::names() {
  static const std::vector<std::string> all = [] {
    std::vector<std::string> result;
    for (const LocalizationMethod& method : methods()) result.push_back(method.name);
    return result;
  }();
  return all;
}

LocalizationMethod LocalizationMethod::named(const std::string& name) {
  const auto found = std::find_if(methods().begin(), methods().end(),
                                  [&name](const LocalizationMethod& method) { return method.name == name; });
  if (found != methods().end()) return *found;
  std::string message = "method = " + name + ": must be one of";
  for (const std::string& known : names()) message += " " + known;
  throw std::invalid_argument(message);
}

}  // namespace saw_ndt
