#include "localization/rival_poses.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "registration/alignment_assessment.h"
#include "saw_ndt/registration/pose_scorer.h"

namespace saw_ndt::internal {
namespace {

constexpr std::size_t kScoredPoints = 600;
constexpr std::size_t kMostRivals = 3;

// A sample of what is not ground, which tells one place of a road from another.
SourcePoints scoredSample(const SourcePoints& source) {
  const auto ground = static_cast<std::uint8_t>(StructuralLabel::GROUND);
  const auto non_ground_count =
      source.size() - static_cast<std::size_t>(std::count(source.label.begin(), source.label.end(), ground));
  const std::size_t stride = std::max<std::size_t>(1, non_ground_count / kScoredPoints);
  SourcePoints sample;
  sample.labelled = source.labelled;
  std::size_t next = 0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    if (source.label[i] == ground || next++ % stride != 0) continue;
    sample.add(source.x[i], source.y[i], source.z[i], static_cast<StructuralLabel>(source.label[i]));
  }
  return sample;
}

// The horizontal direction of greatest variance.
Eigen::Vector3d leastHeldDirection(const AlignmentResult& alignment) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(alignment.covariance.topLeftCorner<2, 2>());
  return {solver.eigenvectors()(0, 1), solver.eigenvectors()(1, 1), 0.0};
}

}  // namespace

std::vector<Eigen::Isometry3d> rivalPoses(const NdtTarget& target, const SourcePoints& source,
                                          const AlignmentResult& alignment, double radius_m, int threads) {
  const Eigen::Vector3d direction = leastHeldDirection(alignment);
  SourcePoints sample = scoredSample(source);
  if (sample.empty()) return {};
  const double step_m = 0.5 * std::max(1.0, target.resolution());
  const int steps = static_cast<int>(std::ceil(radius_m / step_m));
  std::vector<Eigen::Isometry3d> poses;
  for (int i = -steps; i <= steps; ++i) {
    poses.push_back(alignment.T_map_source);
    poses.back().translation() += direction * (i * step_m);
  }
  const std::vector<Likelihoods> likelihoods = PoseScorer(target, sample).score(poses, threads);

  std::vector<std::pair<double, std::size_t>> peaks;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double here = likelihoods[i].non_ground;
    if (i > 0 && likelihoods[i - 1].non_ground > here) continue;
    if (i + 1 < poses.size() && likelihoods[i + 1].non_ground > here) continue;
    const double away_m = std::abs(static_cast<double>(i) - steps) * step_m;
    if (away_m >= kOtherPlace_m) peaks.emplace_back(here, i);
  }
  std::sort(peaks.rbegin(), peaks.rend());
  if (peaks.size() > kMostRivals) peaks.resize(kMostRivals);
  std::vector<Eigen::Isometry3d> rivals;
  for (const auto& [likelihood, i] : peaks) rivals.push_back(poses[i]);
  return rivals;
}

double advantage(const NdtTarget& target, const SourcePoints& source, const Eigen::Isometry3d& T_map_source,
                 const Eigen::Isometry3d& T_map_source_rival) {
  constexpr std::size_t kComparedPoints = 8192;
  const std::size_t stride = std::max<std::size_t>(1, source.size() / kComparedPoints);
  const std::vector<bool> here = pointsOnSurfaces(target, source, T_map_source, stride);
  const std::vector<bool> there = pointsOnSurfaces(target, source, T_map_source_rival, stride);
  double here_alone = 0.0, there_alone = 0.0;
  for (std::size_t i = 0; i < here.size(); ++i) {
    here_alone += here[i] && !there[i] ? 1.0 : 0.0;
    there_alone += there[i] && !here[i] ? 1.0 : 0.0;
  }
  return (here_alone - there_alone) / std::sqrt(std::max(1.0, here_alone + there_alone));
}

}  // namespace saw_ndt::internal
