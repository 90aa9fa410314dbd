#include "localization/rival_poses.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "common/executor.h"
#include "map/voxel_sums_table.h"
#include "registration/alignment_assessment.h"

namespace saw_ndt::internal {
namespace {

// So many points are looked at each place within the first radius; fewer where it is larger, for the same time.
constexpr double kSearchedPoints = 1500.0;
constexpr double kSearchedRadius_m = 60.0;
constexpr double kLeastSearchedPoints = 300.0;
// Posts are thin: within the first radius steps are as short as what they leave in a voxel.
constexpr double kFineRadius_m = 15.0;
constexpr double kFineStep_m = 0.2;
constexpr std::size_t kMostRivals = 4;
constexpr double kRivalsApart_m = 2.0;
// Beside an expected pose, a place that fits worse by more than this is no rival.
constexpr double kClearAdvantage_sigmas = 15.0;
constexpr double kNearRivals_m[] = {-1.2, -0.6, 0.6, 1.2};

struct CoordinateHash {
  std::size_t operator()(const VoxelCoordinate& voxel) const { return hashCoordinate(voxel); }
};

Eigen::Isometry3d movedOn(const Eigen::Isometry3d& T_map_source, const SearchedWay& way, double distance_m) {
  const Eigen::Vector3d turned = way.turn_per_m * distance_m;
  Eigen::Isometry3d T = T_map_source;
  T.translation() += meanRotation(turned) * way.direction * distance_m;
  T.linear() = rotationFromVector(turned) * T_map_source.linear();
  return T;
}

}  // namespace

FitComparison::FitComparison(const NdtTarget& target, const SourcePoints& source, std::size_t most_points)
    : target_(target) {
  const auto ground = static_cast<std::uint8_t>(StructuralLabel::GROUND);
  const auto ground_count = std::count(source.label.begin(), source.label.end(), ground);
  const std::size_t stride = 1 + (source.size() - static_cast<std::size_t>(ground_count)) / most_points;
  std::unordered_map<VoxelCoordinate, std::size_t, CoordinateHash> cells;
  std::size_t next = 0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    if (source.label[i] == ground || next++ % stride != 0) continue;
    points_.emplace_back(source.x[i], source.y[i], source.z[i]);
    const VoxelCoordinate cell = points_.back().array().floor().cast<int>();
    cell_of_point_.push_back(cells.try_emplace(cell, cells.size()).first->second);
  }
  cell_count_ = cells.size();
}

FitComparison::Fits FitComparison::fitsAt(const Eigen::Isometry3d& T_map_source) const {
  Fits fits(points_.size());
  for (std::size_t i = 0; i < points_.size(); ++i) fits[i] = liesOnSurface(target_, T_map_source * points_[i]);
  return fits;
}

double FitComparison::advantage(const Fits& here, const Fits& there) const {
  std::vector<double> difference(cell_count_, 0.0);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    difference[cell_of_point_[i]] += (here[i] ? 1.0 : 0.0) - (there[i] ? 1.0 : 0.0);
  }
  const double sum = std::accumulate(difference.begin(), difference.end(), 0.0);
  const double squares = std::inner_product(difference.begin(), difference.end(), difference.begin(), 0.0);
  return sum / std::sqrt(std::max(1.0, squares));
}

Eigen::Vector3d leastHeldDirection(const Matrix6d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(covariance.topLeftCorner<2, 2>());
  return {solver.eigenvectors()(0, 1), solver.eigenvectors()(1, 1), 0.0};
}

std::vector<Eigen::Isometry3d> rivalStarts(const NdtTarget& target, const SourcePoints& source,
                                           const Eigen::Isometry3d& T_map_source, const SearchedWay& way,
                                           double radius_m, bool is_expected, int threads) {
  const double step_m = radius_m <= kFineRadius_m ? kFineStep_m : 0.5 * std::max(1.0, target.resolution());
  const int steps = static_cast<int>(std::ceil(radius_m / step_m));
  std::vector<Eigen::Isometry3d> poses;
  for (int i = -steps; i <= steps; ++i) {
    poses.push_back(movedOn(T_map_source, way, i * step_m));
  }
  const double points = std::max(kLeastSearchedPoints, kSearchedPoints * std::min(1.0, kSearchedRadius_m / radius_m));
  const FitComparison comparison(target, source, static_cast<std::size_t>(points));
  const FitComparison::Fits here = comparison.fitsAt(T_map_source);
  std::vector<double> advantage_of_here(poses.size());
  forEachChunk(threads, poses.size(), [&](std::size_t i, int) {
    advantage_of_here[i] = comparison.advantage(here, comparison.fitsAt(poses[i]));
  });

  const double worst = is_expected ? kClearAdvantage_sigmas : std::numeric_limits<double>::infinity();
  std::vector<std::pair<double, std::size_t>> candidates;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (i > 0 && advantage_of_here[i - 1] < advantage_of_here[i]) continue;
    if (i + 1 < poses.size() && advantage_of_here[i + 1] < advantage_of_here[i]) continue;
    const double away_m = std::abs(static_cast<double>(i) - steps) * step_m;
    if (away_m >= kRivalsApart_m && advantage_of_here[i] < worst) candidates.emplace_back(advantage_of_here[i], i);
  }
  std::sort(candidates.begin(), candidates.end());
  std::vector<Eigen::Isometry3d> rivals;
  for (const auto& [advantage, i] : candidates) {
    const Eigen::Vector3d& position = poses[i].translation();
    const bool is_another = std::none_of(rivals.begin(), rivals.end(), [&](const Eigen::Isometry3d& rival) {
      return (rival.translation() - position).norm() < kRivalsApart_m;
    });
    if (is_another) rivals.push_back(poses[i]);
    if (rivals.size() == kMostRivals) break;
  }
  if (is_expected) return rivals;
  for (const double away_m : kNearRivals_m) {
    rivals.push_back(movedOn(T_map_source, way, away_m));
  }
  return rivals;
}

}  // namespace saw_ndt::internal
