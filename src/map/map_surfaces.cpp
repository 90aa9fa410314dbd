#include "map/map_surfaces.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iterator>

#include "map/sums_statistics.h"

namespace saw_ndt::internal {
namespace {

// Fewer points tell no covariance of their own.
constexpr std::uint64_t kLeastPointsOfCovariance = 6;
// A flat voxel has a least eigenvalue below this share of the second one, and a second standard deviation of so many
// edges or more: points that cover a face have 0.29.
constexpr double kFlat = 0.1, kLeastSpread = 0.12;
// Two surfaces are parallel up to 20 degrees.
constexpr float kParallel = 0.94F;
// How well a surface is met again by other scans and beams, however many (m): flat voxels of halves of real drives are
// 1 cm apart at most, 19 of 20 of them.
constexpr float kRepeatability_m = 0.0075F;

VoxelWeighting anyLabelAlike() {
  VoxelWeighting weighting;
  weighting.confidence = ConfidenceOptions::uniform();
  weighting.min_points_per_voxel = kLeastPointsOfSurface;
  weighting.min_eigenvalue_ratio = 1e-4;
  return weighting;
}

Surface surfaceOf(const VoxelStatistics& voxel, double resolution_m) {
  Surface surface;
  surface.voxel = voxel.voxel;
  surface.mean_from_centre = voxel.mean_from_centre.cast<float>();
  surface.point_count = voxel.point_count;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(voxel.covariance);
  const Eigen::Vector3d& variances = eigen.eigenvalues();  // ascending
  surface.normal = eigen.eigenvectors().col(0).cast<float>();
  if (voxel.point_count < kLeastPointsOfCovariance) {
    surface.covariance = Eigen::Matrix3f::Identity() * static_cast<float>(resolution_m * resolution_m / 12.0);
    return surface;
  }
  surface.covariance = voxel.covariance.cast<float>();
  surface.flat = variances[0] < kFlat * variances[1] && std::sqrt(variances[1]) >= kLeastSpread * resolution_m;
  return surface;
}

// Completes a surface by the entries of its voxel, which begin at `entry` or later.
const LabelledVoxelSums* addEntries(const LabelledVoxelSums* entry, const LabelledVoxelSums* last, Surface& surface) {
  while (entry->voxel != surface.voxel) ++entry;
  std::uint64_t most_points = 0;
  for (; entry != last && entry->voxel == surface.voxel; ++entry) {
    surface.scan_count = std::max(surface.scan_count, entry->scan_count);
    if (entry->sums.count < most_points) continue;
    most_points = entry->sums.count;
    surface.label = entry->label;
  }
  return entry;
}

// Variance of a plane's height at `offset_m` from its mean: that of a plane fitted to points, of which those of one
// scan, whose pose they share, count as one.
float heightVariance(const Surface& surface, const Eigen::Vector3f& normal, const Eigen::Vector3f& offset_m) {
  const float across_m2 = normal.dot(surface.covariance * normal);
  const Eigen::Vector3f lateral_m = offset_m - normal * normal.dot(offset_m);
  const Eigen::Matrix3f inverse = surface.covariance.inverse();
  const float leverage = lateral_m.dot(inverse * lateral_m);
  return across_m2 * (1.0F + leverage) / static_cast<float>(std::max(surface.scan_count, 1U));
}

}  // namespace

MapSurfaces::MapSurfaces(const WeightedVoxelMap& map, int threads) : resolution_m_(map.resolution()) {
  const VoxelWeighting weighting = anyLabelAlike();
  std::vector<std::vector<Surface>> parts;
  forEachPartOfVoxels(
      map.entries(), threads, [&parts](std::size_t part_count) { parts.resize(part_count); },
      [&](std::size_t part, const LabelledVoxelSums* first, const LabelledVoxelSums* last) {
        const LabelledVoxelSums* entry = first;
        forEachStatistics(first, last, weighting, {}, resolution_m_ / kStepsPerVoxel,
                          [&](const std::vector<VoxelStatistics>& batch) {
                            for (const VoxelStatistics& voxel : batch) {
                              parts[part].push_back(surfaceOf(voxel, resolution_m_));
                              entry = addEntries(entry, last, parts[part].back());
                            }
                          });
      });
  for (std::vector<Surface>& part : parts) {
    surfaces_.insert(surfaces_.end(), part.begin(), part.end());
    std::vector<Surface>().swap(part);
  }
  std::vector<VoxelCoordinate> voxels;
  voxels.reserve(surfaces_.size());
  std::transform(surfaces_.begin(), surfaces_.end(), std::back_inserter(voxels),
                 [](const Surface& surface) { return surface.voxel; });
  index_ = VoxelIndex(voxels);
}

SurfacePair pairOf(const Surface& first, const Surface& second, double resolution_m) {
  SurfacePair pair;
  const Eigen::Vector3f between_m = (second.voxel - first.voxel).cast<float>() * static_cast<float>(resolution_m) +
                                    (second.mean_from_centre - first.mean_from_centre);
  const float cosine = first.normal.dot(second.normal);
  pair.both_flat = first.flat && second.flat && std::abs(cosine) >= kParallel;
  if (!pair.both_flat) {
    const Eigen::Matrix3f covariance =
        first.covariance + second.covariance + Eigen::Matrix3f::Identity() * (kRepeatability_m * kRepeatability_m);
    pair.mahalanobis2 = between_m.dot(covariance.inverse() * between_m);
    return pair;
  }
  // At the middle of both means, where errors of the normals, and curvature, cancel.
  const Eigen::Vector3f other = cosine < 0.0F ? Eigen::Vector3f(-second.normal) : second.normal;
  pair.normal = (first.normal + other).normalized();
  int greatest = 0;
  pair.normal.cwiseAbs().maxCoeff(&greatest);
  if (pair.normal[greatest] < 0.0F) pair.normal = -pair.normal;
  pair.gap_m = pair.normal.dot(between_m);
  pair.gap_sigma_m =
      std::sqrt(heightVariance(first, pair.normal, 0.5F * between_m) +
                heightVariance(second, pair.normal, -0.5F * between_m) + 2.0F * kRepeatability_m * kRepeatability_m);
  return pair;
}

}  // namespace saw_ndt::internal
