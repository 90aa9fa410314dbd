// A drive through a street of which any scans, stamps and measurements of other sensors come.
#include <cmath>
#include <stdexcept>

#include "fuzzed_clouds.h"
#include "fuzzed_file.h"
#include "saw_ndt/localization/localizer.h"
#include "saw_ndt/map/weighted_map_builder.h"

namespace saw_ndt {
namespace {

NdtTarget streetTarget(const LocalizerOptions& options) {
  const std::uint8_t street[] = {0, 3};  // see anyScan(): what is consumed last comes first
  FuzzedDataProvider provider(street, sizeof street);
  const ScanPoints scan = anyScan(provider);
  std::vector<StructuralLabel> labels;
  for (const LidarPoint& point : scan.points) {
    labels.push_back(point.z < -1.6F ? StructuralLabel::GROUND : StructuralLabel::NON_GROUND);
  }
  WeightedMapBuilder builder(1.0);
  builder.addScan(viewOf(scan), LabelView(labels), Eigen::Isometry3d::Identity(), 1);
  return NdtTarget(builder.build(), options.method.voxels, 1);
}

ScanPriors anyPriors(FuzzedDataProvider& provider) {
  ScanPriors priors;
  const auto form = provider.ConsumeIntegral<std::uint8_t>();
  if (form % 4 == 1) {
    priors.motion.emplace();
    priors.motion->T_before_now = anyPose(provider, 3.0);
    priors.motion->covariance.diagonal().setConstant(static_cast<double>(anyFloat(provider, 1e-4F)));
  }
  if (form % 8 == 2) {
    priors.position.emplace();
    priors.position->position_m = anyPose(provider, 20.0).translation();
    priors.position->covariance.diagonal().setConstant(static_cast<double>(anyFloat(provider, 1e-3F)));
  }
  return priors;
}

void requireSound(const LocalizationResult& result) {
  require(result.T_map_base.matrix().allFinite() && result.T_map_base.linear().isUnitary(1e-6), "poses are rigid");
  require(result.covariance.allFinite(), "covariances are finite");
  require(!result.accepted() || result.alignment.converged(), "what is accepted has converged");
  require(!result.accepted() || result.T_map_base.translation().norm() < 1e3, "what is accepted is where the map is");
}

}  // namespace
}  // namespace saw_ndt

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace saw_ndt;
  static const LocalizerOptions defaults = [] {
    LocalizerOptions options;
    options.alignment.threads = 1;
    options.global_search.heading_step_deg = 10.0;
    return options;
  }();
  static const NdtTarget target = streetTarget(defaults);
  FuzzedDataProvider provider(data, size);
  LocalizerOptions options = defaults;
  options.search = provider.ConsumeIntegral<std::uint8_t>() % 8 == 0;  // its index takes most of the time
  options.motion_compensation = provider.ConsumeBool() ? MotionCompensation::FROM_TIMES : MotionCompensation::OFF;
  Localizer localizer(target, options);
  localizer.setInitialPose(Eigen::Isometry3d::Identity());
  double stamp_s = 0.0;
  for (int scans = 0; scans < 6 && provider.remaining_bytes() > 0; ++scans) {
    stamp_s += static_cast<double>(anyFloat(provider, 1e-4F));
    const ScanPriors priors = anyPriors(provider);
    const ScanPoints scan = anyScan(provider);
    try {
      requireSound(localizer.localize(viewOf(scan), stamp_s, priors));
    } catch (const std::invalid_argument&) {  // of a stamp or a prior that is none
    }
    if (!std::isfinite(stamp_s)) stamp_s = 0.0;
  }
  return 0;
}
