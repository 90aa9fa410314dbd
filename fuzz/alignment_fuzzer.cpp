// Registration of any cloud to any other from anywhere.
#include <cmath>
#include <stdexcept>

#include "fuzzed_clouds.h"
#include "fuzzed_file.h"
#include "saw_ndt/map/ndt_target.h"
#include "saw_ndt/map/weighted_map_builder.h"
#include "saw_ndt/registration/ndt_aligner.h"

namespace saw_ndt {
namespace {

NdtTarget anyTarget(FuzzedDataProvider& provider) {
  WeightedMapBuilder builder(provider.ConsumeBool() ? 1.0 : 0.5);
  const ScanPoints scan = anyScan(provider);
  const std::vector<StructuralLabel> labels = anyLabels(provider, scan.points.size());
  builder.addScan(viewOf(scan), provider.ConsumeBool() ? LabelView(labels) : LabelView(), Eigen::Isometry3d::Identity(),
                  1);
  VoxelWeighting weighting;
  weighting.unbounded_ground = provider.ConsumeBool();
  return NdtTarget(builder.build(), weighting, 1, CellPrecision::SINGLE_AND_DOUBLE);
}

AlignmentOptions anyOptions(FuzzedDataProvider& provider) {
  AlignmentOptions options;
  const auto form = provider.ConsumeIntegral<std::uint8_t>();
  options.threads = 1;
  options.optimizer = (form & 1U) != 0 ? Optimizer::NEWTON_MORE_THUENTE : Optimizer::DAMPED_NEWTON;
  options.arithmetic = (form & 2U) != 0 ? Arithmetic::DOUBLE : Arithmetic::SINGLE;
  options.use_weights = (form & 4U) != 0;
  options.use_coarse_level = (form & 8U) != 0;
  options.evaluate_likelihoods = (form & 16U) != 0;
  options.ground_in_own_column = (form & 32U) != 0;
  options.max_iterations = 1 + (form >> 6U) * 10;
  return options;
}

void requireSound(const AlignmentResult& result, const Eigen::Isometry3d& guess, const AlignmentOptions& options) {
  const Eigen::Matrix3d R = result.T_map_source.linear();
  require(result.T_map_source.matrix().allFinite(), "poses are finite");
  require(!guess.linear().isUnitary(1e-9) || R.isUnitary(1e-6), "poses are rigid");
  require(std::isfinite(result.score) && std::isfinite(result.likelihood), "scores are finite");
  require(result.information.allFinite() && result.covariance.allFinite(), "covariances are finite");
  require(!(result.overlap < 0.0) && !(result.overlap > 1.0), "the overlap is a share or not told");
  require(!result.converged() || !(result.overlap < options.min_overlap), "what converged overlaps");
  require(!result.converged() || result.covariance.trace() > 0.0, "what converged has a covariance");
}

}  // namespace
}  // namespace saw_ndt

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace saw_ndt;
  FuzzedDataProvider provider(data, size);
  const AlignmentOptions options = anyOptions(provider);
  const Eigen::Isometry3d guess = anyPose(provider, 5.0);
  const NdtTarget target = anyTarget(provider);
  const SourcePoints source = anySource(provider);
  NdtAligner aligner;
  try {
    requireSound(aligner.align(target, source, guess, options), guess, options);
  } catch (const std::invalid_argument&) {
    require(!guess.matrix().allFinite(), "only a guess that is not finite is refused");
  }
  return 0;
}
