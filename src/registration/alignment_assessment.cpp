#include "registration/alignment_assessment.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "common/executor.h"
#include "map/ndt_level.h"
#include "registration/score_function.h"
#include "registration/voxel_pairs.h"

namespace saw_ndt::internal {
namespace {

constexpr std::size_t kSampledPoints = 1024;
constexpr std::size_t kPointsPerChunk = 128;

// Fewer sampled points on surfaces of the map, each at another place, determine no pose of six parameters.
constexpr std::size_t kMinMatchedPoints = 10;

// A point lies on the surface of its voxel within so many squared standard deviations.
constexpr double kMaxSquaredMahalanobis = 9.0;

// A voxel in which several surfaces lie, or leaves alone, is thicker than this in every direction (m, of voxels of 1 m
// or less; in larger ones so much thicker): whatever lies in it fits, and tells nothing.
constexpr double kMostThickness_m = 0.3;

// The share of the curvature along the normal of a surface that a direction must have to count. Normals of small voxels
// are not known better than to 6 degrees, which the covariance reckons with; along a tunnel or the rails of a bridge
// all that there is comes from joints and other small things, less than 16 degrees from the surface.
constexpr double kNegligibleCurvatureShare = 0.01;
constexpr double kDoubtfulCurvatureShare = 0.08;

// A direction is free where less of its curvature than this is beyond doubt. Measured: up to 0.05 in tunnels and 0.09
// on a bridge, 0.24 and more along a motorway.
constexpr double kMinHeldShare = 0.15;

// So many points bear as much information as more of them: what remains is the error of the map.
constexpr double kIndependentPoints = 15000.0;

// Where less of a scan than this is not ground, its overlap is that of all points.
constexpr double kMinJudgedShare = 0.1;

// The six directions in which the curvature is diagonal, each as a motion of the points.
struct Motions {
  std::array<Eigen::Vector3d, 6> translation, rotation;
};

// Places of points, each once and no more than count: a point that is given many times tells no more than once.
class Places {
 public:
  void add(const Eigen::Vector3f& place) {
    if (count_ == places_.size()) return;
    const auto end = places_.begin() + static_cast<std::ptrdiff_t>(count_);
    if (std::find(places_.begin(), end, place) == end) places_[count_++] = place;
  }
  void add(const Places& others) {
    for (std::size_t i = 0; i < others.count_; ++i) add(others.places_[i]);
  }
  bool areEnough() const { return count_ == places_.size(); }

 private:
  std::array<Eigen::Vector3f, kMinMatchedPoints> places_;
  std::size_t count_ = 0;
};

struct SampleSums {
  Vector6d curvature = Vector6d::Zero();    // along each direction
  Vector6d held = Vector6d::Zero();         // without what is negligible
  Vector6d surely_held = Vector6d::Zero();  // without what is doubtful
  std::size_t sampled = 0;
  std::size_t matched = 0;  // points on a surface
  std::size_t judged = 0;   // points that overlap is told of
  std::size_t judged_and_matched = 0;
  Places matched_places;

  SampleSums& operator+=(const SampleSums& other) {
    curvature += other.curvature;
    held += other.held;
    surely_held += other.surely_held;
    sampled += other.sampled;
    matched += other.matched;
    judged += other.judged;
    judged_and_matched += other.judged_and_matched;
    matched_places.add(other.matched_places);
    return *this;
  }
};

// The voxel of the finest level that has one where a point lies.
struct SurfaceAt {
  const PackedNdtCell* cell = nullptr;  // null: there is none
  std::size_t level = 0;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  // of the point from its mean
  Eigen::Matrix3d inverse_covariance = Eigen::Matrix3d::Zero();
  double squared_mahalanobis = 0.0;
  bool thin = false;

  bool fits() const { return thin && squared_mahalanobis < kMaxSquaredMahalanobis; }
};

SurfaceAt surfaceAt(const std::vector<NdtLevel>& levels, const Eigen::Vector3d& p) {
  constexpr double kFarthestVoxel = 1.0e9;
  SurfaceAt surface;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const double resolution_m = levels[i].resolution();
    const Eigen::Vector3d voxel = (p / resolution_m).array().floor();
    if (!(voxel.array().abs() < kFarthestVoxel).all()) break;
    const std::int32_t number = levels[i].index().find(voxel.cast<int>());
    if (number == VoxelIndex::kNone) continue;
    const PackedNdtCell& cell = levels[i].packedCells()[static_cast<std::size_t>(number)];
    surface.cell = &cell;
    surface.level = i;
    surface.offset = p - (voxel.array() + 0.5).matrix() * resolution_m -
                     Eigen::Map<const Eigen::Vector3f>(cell.mean_from_centre).cast<double>();
    surface.inverse_covariance = inverseCovarianceOf(cell);
    const double most_thickness_m = kMostThickness_m * std::max(1.0, levels.front().resolution());
    surface.thin = surface.inverse_covariance.trace() * most_thickness_m * most_thickness_m > 1.0;
    surface.squared_mahalanobis = surface.offset.dot(surface.inverse_covariance * surface.offset);
    break;
  }
  return surface;
}

class PointSampler {
 public:
  PointSampler(const NdtTarget& target, const SourcePoints& source, const AlignmentOptions& options,
               const Eigen::Isometry3d& T_map_source, const Motions& motions)
      : target_(target),
        source_(source),
        weighted_(options.use_weights && target.labelled() && source.labelled),
        T_map_source_(T_map_source),
        motions_(motions) {
    for (std::size_t i = 0; i < target.levels().size(); ++i) {
      scores_[i] = scoreParameters(options.score_function, options.outlier_ratio, target.levels()[i].resolution());
    }
  }

  void add(std::size_t point, SampleSums& sums) const {
    const Eigen::Vector3d r =
        T_map_source_.linear() * Eigen::Vector3d(source_.x[point], source_.y[point], source_.z[point]);
    const SurfaceAt surface = surfaceAt(target_.levels(), r + T_map_source_.translation());
    const bool ground = source_.label[point] == static_cast<std::uint8_t>(StructuralLabel::GROUND);
    ++sums.sampled;
    if (surface.cell == nullptr) {
      sums.judged += ground ? 0 : 1;
      return;
    }
    const Eigen::Matrix3d& inverse_covariance = surface.inverse_covariance;
    const double trace = inverse_covariance.trace();
    const bool judged = source_.labelled ? !ground : !isLevel(*surface.cell);
    sums.judged += judged ? 1 : 0;
    sums.judged_and_matched += judged && surface.fits() ? 1 : 0;
    sums.matched += surface.fits() ? 1 : 0;
    if (surface.fits()) sums.matched_places.add({source_.x[point], source_.y[point], source_.z[point]});

    const ScoreParameters& score = scores_[surface.level];
    const double weight = score.amplitude * score.d2 * std::exp(-0.5 * score.d2 * surface.squared_mahalanobis) *
                          (weighted_ ? surface.cell->weight : 1.0F);
    for (int k = 0; k < 6; ++k) {
      const Eigen::Vector3d moved = motions_.translation[k] + motions_.rotation[k].cross(r);
      const double along = moved.dot(inverse_covariance * moved);
      sums.curvature[k] += weight * along;
      const double across = trace * moved.squaredNorm();
      sums.held[k] += weight * std::max(0.0, along - kNegligibleCurvatureShare * across);
      sums.surely_held[k] += weight * std::max(0.0, along - kDoubtfulCurvatureShare * across);
    }
  }

 private:
  const NdtTarget& target_;
  const SourcePoints& source_;
  bool weighted_;
  Eigen::Isometry3d T_map_source_;
  const Motions& motions_;
  std::array<ScoreParameters, kMostLevels> scores_;
};

}  // namespace

void assessAlignment(const NdtTarget& target, const SourcePoints& source, const AlignmentOptions& options,
                     AlignmentResult& result) {
  // In lengths: rotations as the way of a point at the end of an arm.
  Vector6d unit = Vector6d::Ones();
  unit.tail<3>() /= kRotationArm_m;
  const Eigen::SelfAdjointEigenSolver<Matrix6d> curvature(unit.asDiagonal() * result.information * unit.asDiagonal());
  Motions motions;
  for (int k = 0; k < 6; ++k) {
    motions.translation[k] = curvature.eigenvectors().col(k).head<3>();
    motions.rotation[k] = curvature.eigenvectors().col(k).tail<3>() / kRotationArm_m;
  }

  SampleSums sums;
  if (result.T_map_source.matrix().allFinite()) {
    const PointSampler sampler(target, source, options, result.T_map_source, motions);
    const std::size_t stride = (source.size() + kSampledPoints - 1) / kSampledPoints;
    const std::size_t sampled = (source.size() + stride - 1) / stride;
    std::array<SampleSums, kSampledPoints / kPointsPerChunk> of_chunk;
    const std::size_t chunks = (sampled + kPointsPerChunk - 1) / kPointsPerChunk;
    forEachChunk(threadCount(options.threads), chunks, [&](std::size_t chunk, int) {
      const std::size_t end = std::min(sampled, (chunk + 1) * kPointsPerChunk);
      for (std::size_t i = chunk * kPointsPerChunk; i < end; ++i) sampler.add(i * stride, of_chunk[chunk]);
    });
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) sums += of_chunk[chunk];
  }

  // On bare land there is next to nothing but ground to judge by; what it does not hold, free directions tell.
  const bool judge_ground = static_cast<double>(sums.judged) < kMinJudgedShare * static_cast<double>(sums.sampled);
  const std::size_t judged = judge_ground ? sums.sampled : sums.judged;
  const std::size_t matched = judge_ground ? sums.matched : sums.judged_and_matched;
  result.overlap = judged == 0 ? 0.0 : static_cast<double>(matched) / static_cast<double>(judged);
  const double scale =
      options.covariance_scale * std::max(1.0, static_cast<double>(source.size()) / kIndependentPoints);
  Vector6d variance;
  result.free_directions.resize(6, 0);
  for (int k = 0; k < 6; ++k) {
    const double per_curvature = sums.curvature[k] > 0.0 ? curvature.eigenvalues()[k] / sums.curvature[k] : 0.0;
    const bool is_held = sums.surely_held[k] >= kMinHeldShare * sums.curvature[k];
    const double held = per_curvature * (is_held ? sums.held[k] : sums.surely_held[k]);
    variance[k] = held > 0.0 ? scale / held : kFreeSigma_m * kFreeSigma_m;
    if (is_held && variance[k] < kFreeSigma_m * kFreeSigma_m) continue;
    result.free_directions.conservativeResize(6, result.free_directions.cols() + 1);
    result.free_directions.rightCols<1>() = curvature.eigenvectors().col(k);
  }
  const Matrix6d directions = unit.asDiagonal() * curvature.eigenvectors();
  result.covariance =
      directions * variance.asDiagonal() * directions.transpose() + freeCovariance(result.free_directions);
  const bool fits = sums.matched_places.areEnough() && result.overlap >= options.min_overlap;
  if (!fits && (result.converged() || result.status == AlignmentStatus::ITERATION_LIMIT)) {
    result.status = AlignmentStatus::UNDETERMINED;
  }
}

bool liesOnSurface(const NdtTarget& target, const Eigen::Vector3d& position_m) {
  return surfaceAt(target.levels(), position_m).fits();
}

}  // namespace saw_ndt::internal
