#include "saw_ndt/registration/pose_scorer.h"

#include <algorithm>

#include "common/executor.h"
#include "registration/batch_voxel_finder.h"
#include "registration/likelihoods.h"
#include "registration/source_check.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt {

struct PoseScorer::Parts {
  NdtTarget target;
  double outlier_ratio;
  internal::OrderedSource source;
  internal::BatchWorkspace workspace;
  struct OfWorker {
    internal::OrderedSource source;  // in the order of the last pose
    internal::LevelledSource levelled;
    internal::BatchWorkspace workspace;
  };
  std::vector<OfWorker> of_worker;  // where the target has several levels

  Likelihoods onLevels(const Eigen::Isometry3d& T_map_source, OfWorker& own) const {
    own.source = source;
    own.levelled.assign(target, own.source, T_map_source, 0, false, 1, own.workspace);
    return internal::evaluateLikelihoods(target, own.levelled, T_map_source, outlier_ratio, 1, own.workspace);
  }
};

PoseScorer::PoseScorer(const NdtTarget& target, const SourcePoints& source, double outlier_ratio)
    : parts_(std::make_unique<Parts>()) {
  checkOption(outlier_ratio > 0.0 && outlier_ratio < 1.0, "outlier_ratio", outlier_ratio, "between 0 and 1, exclusive");
  internal::requireRegistrable(source);
  parts_->target = target;
  parts_->outlier_ratio = outlier_ratio;
  parts_->source.order(source, target.resolution(), ConfidenceOptions::uniform());
  // In one order for all poses, that of the source's own frame: voxels are as large in every other.
  parts_->workspace.prepare(1);
  const internal::BatchVoxelFinder finder(target.fine(), NeighborhoodSearchMethod::DIRECT1,
                                          Eigen::Isometry3d::Identity());
  for (std::size_t first = 0; first < parts_->source.size(); first += internal::kPointsPerBatch) {
    finder.find(parts_->source, first, std::min(internal::kPointsPerBatch, parts_->source.size() - first),
                *parts_->workspace.scratch_of_worker.front());
  }
}

PoseScorer::~PoseScorer() = default;
PoseScorer::PoseScorer(PoseScorer&& other) noexcept = default;
PoseScorer& PoseScorer::operator=(PoseScorer&& other) noexcept = default;

std::vector<Likelihoods> PoseScorer::score(const std::vector<Eigen::Isometry3d>& poses, int threads) {
  Parts& parts = *parts_;
  std::vector<Likelihoods> likelihoods(poses.size());
  parts.workspace.prepare(internal::threadCount(threads));
  const bool several_levels = parts.target.levels().size() > 1;
  if (several_levels) parts.of_worker.resize(static_cast<std::size_t>(internal::threadCount(threads)));
  internal::forEachChunk(threads, poses.size(), [&](std::size_t i, int worker) {
    if (several_levels) {
      likelihoods[i] = parts.onLevels(poses[i], parts.of_worker[static_cast<std::size_t>(worker)]);
      return;
    }
    likelihoods[i] = internal::likelihoodsInOrder(parts.target.fine(), parts.source, poses[i], parts.outlier_ratio,
                                                  *parts.workspace.scratch_of_worker[static_cast<std::size_t>(worker)]);
  });
  return likelihoods;
}

}  // namespace saw_ndt
