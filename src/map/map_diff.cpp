#include "saw_ndt/map/map_diff.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/executor.h"
#include "map/change_groups.h"
#include "map/map_metadata.h"
#include "map/map_surfaces.h"
#include "map/seen_places.h"
#include "saw_ndt/common/error.h"
#include "segmentation/segmentation_fields.h"

namespace saw_ndt {

using namespace internal;

namespace {

// Squared Mahalanobis distance within which the points of two voxels may be those of one thing: chi-squared of three
// degrees of freedom, 99 %.
constexpr float kSameThing = 11.34F;
// Standard deviations by which a gap must differ from none: 99.9 %.
constexpr float kSignificance = 3.29F;
constexpr std::size_t kChunk = 4096;

struct Side {
  Side(const WeightedVoxelMap& map, const MapDiffOptions& options, int threads)
      : surfaces(map, threads), seen(surfaces), least_points(static_cast<std::uint64_t>(options.least_points)) {
    const auto scans = static_cast<std::uint64_t>(options.least_scans);
    const std::uint64_t least_scans = map.origin().scan_count < scans ? 0 : scans;
    for (const Surface& surface : surfaces.all()) {
      const bool stays = surface.scan_count == 0 ||
                         (surface.scan_count >= least_scans &&
                          surface.scan_count >= options.least_share_of_scans * seen.mostScansAround(surface.voxel));
      compared.push_back(static_cast<char>(stays && surface.point_count >= least_points));
    }
    same.assign(compared.size(), 0);
    found.resize(compared.size());
  }

  struct Found {
    bool changed = false, moved = false, not_covered = false;
    Eigen::Vector3f displacement_m = Eigen::Vector3f::Zero();
  };

  MapSurfaces surfaces;
  SeenPlaces seen;
  std::uint64_t least_points;
  std::vector<char> compared;  // whether there is enough of a surface to say that it has changed
  std::vector<char> same;      // whether the other map has it, too
  std::vector<Found> found;
};

class Comparison {
 public:
  Comparison(const Side& here, const Side& there, const MapDiffOptions& options)
      : here_(here), there_(there), least_m_(static_cast<float>(options.least_displacement_m)) {}

  // Whether the other map has the surface, too: something whose points may be those of one thing with it, a parallel
  // surface nearer than what counts, or one that is no further away than can be told.
  bool isSame(const Surface& surface, VoxelIndex::Cursor& cursor) const {
    float least_sigma_m = std::numeric_limits<float>::infinity(), its_gap_m = least_sigma_m;
    return there_.surfaces.anyAround(surface.voxel, cursor, [&](std::size_t number) {
      const SurfacePair pair = pairOf(surface, there_.surfaces.all()[number], here_.surfaces.resolution());
      if (!pair.both_flat) return pair.mahalanobis2 <= kSameThing;
      if (pair.gap_sigma_m < least_sigma_m) {
        least_sigma_m = pair.gap_sigma_m;
        its_gap_m = std::abs(pair.gap_m);
      }
      return std::abs(pair.gap_m) < least_m_;
    }) || its_gap_m < kSignificance * least_sigma_m;
  }

  // What has become of a surface that is compared and not the same.
  Side::Found fate(const Surface& surface, VoxelIndex::Cursor& cursor) const {
    Side::Found fate;
    const auto most_m = static_cast<float>(here_.surfaces.resolution());
    float least_sigma_m = std::numeric_limits<float>::infinity();
    there_.surfaces.anyAround(surface.voxel, cursor, [&](std::size_t number) {
      if (there_.same[number] != 0 || there_.compared[number] == 0) return false;
      const SurfacePair pair = pairOf(surface, there_.surfaces.all()[number], here_.surfaces.resolution());
      if (!pair.both_flat || std::abs(pair.gap_m) > most_m || !(pair.gap_sigma_m < least_sigma_m)) return false;
      // The best known gap; the least one would be too small.
      least_sigma_m = pair.gap_sigma_m;
      fate.moved = true;
      fate.displacement_m = pair.gap_m * pair.normal;
      return false;
    });
    if (fate.moved) return fate;
    fate.changed = there_.seen.cover(surface.voxel, surface.point_count, here_.seen, here_.least_points);
    fate.not_covered = !fate.changed;
    return fate;
  }

 private:
  const Side& here_;
  const Side& there_;
  float least_m_;
};

template <typename Visit>
void forEachSurface(const Side& side, int threads, const Visit& visit) {
  const std::vector<Surface>& surfaces = side.surfaces.all();
  forEachChunkOffline(threads, (surfaces.size() + kChunk - 1) / kChunk, [&](std::size_t chunk, int) {
    VoxelIndex::Cursor cursor;
    const std::size_t last = std::min(surfaces.size(), (chunk + 1) * kChunk);
    for (std::size_t i = chunk * kChunk; i < last; ++i) visit(i, surfaces[i], cursor);
  });
}

void appendChanges(const Side& side, bool is_second, std::vector<ChangedVoxel>& changes) {
  const double resolution_m = side.surfaces.resolution();
  for (std::size_t i = 0; i < side.found.size(); ++i) {
    const Side::Found& found = side.found[i];
    if (!found.changed && !found.moved) continue;
    const Surface& surface = side.surfaces.all()[i];
    ChangedVoxel& changed = changes.emplace_back();
    changed.voxel = surface.voxel;
    changed.change = found.moved ? VoxelChange::MOVED : is_second ? VoxelChange::APPEARED : VoxelChange::VANISHED;
    changed.in_second = is_second;
    changed.point_count = surface.point_count;
    changed.label = surface.label;
    changed.mean_m =
        (surface.voxel.cast<double>().array() + 0.5).matrix() * resolution_m + surface.mean_from_centre.cast<double>();
    changed.displacement_m = (is_second ? -1.0 : 1.0) * found.displacement_m.cast<double>();
  }
}

MapDiffSide sumUp(const WeightedVoxelMap& map, const Side& side, bool is_second,
                  const std::vector<ChangedVoxel>& changes) {
  MapDiffSide sum;
  const VoxelCoordinate* before = nullptr;
  for (const LabelledVoxelSums& entry : map.entries()) {
    if (before == nullptr || entry.voxel != *before) ++sum.voxels;
    before = &entry.voxel;
  }
  for (std::size_t i = 0; i < side.found.size(); ++i) {
    if (side.compared[i] == 0) continue;
    ++sum.compared;
    if (side.found[i].not_covered) ++sum.not_covered;
  }
  for (const ChangedVoxel& changed : changes) {
    if (changed.in_second != is_second) continue;
    ++(changed.change == VoxelChange::MOVED ? sum.moved : sum.changed);
  }
  sum.unchanged = sum.compared - sum.changed - sum.moved - sum.not_covered;
  return sum;
}

void measureGaps(const Side& first, const Side& second, MapDiff& diff) {
  std::vector<float> gaps_m;
  VoxelIndex::Cursor cursor;
  for (std::size_t i = 0; i < first.compared.size(); ++i) {
    if (first.compared[i] == 0) continue;
    const Surface& surface = first.surfaces.all()[i];
    second.surfaces.anyAround(surface.voxel, cursor, [&](std::size_t number) {
      const Surface& other = second.surfaces.all()[number];
      if (other.voxel != surface.voxel || second.compared[number] == 0) return true;
      const SurfacePair pair = pairOf(surface, other, diff.resolution_m);
      if (pair.both_flat) gaps_m.push_back(pair.gap_m);
      return true;
    });
  }
  diff.gap_count = gaps_m.size();
  if (gaps_m.empty()) return;
  std::sort(gaps_m.begin(), gaps_m.end());
  // Symmetric about the middle, so that maps in the other order have the same figures with the other sign.
  const std::size_t last = gaps_m.size() - 1, tail = last / 20;
  diff.gap_percentiles_m = {gaps_m[tail], 0.5 * (double{gaps_m[last / 2]} + double{gaps_m[last - last / 2]}),
                            gaps_m[last - tail]};
}

void requireComparable(const MapOrigin& first, const MapOrigin& second) {
  checkOption(first.resolution_m == second.resolution_m, "resolution_m", fieldText(second.resolution_m),
              ("that of the other map, " + fieldText(first.resolution_m)).c_str());
  checkOption(first.map_origin_m == second.map_origin_m, "map_origin_m", positionText(second.map_origin_m),
              ("that of the other map, " + positionText(first.map_origin_m)).c_str());
}

}  // namespace

std::string toString(VoxelChange change) {
  return change == VoxelChange::APPEARED ? "appeared" : change == VoxelChange::VANISHED ? "vanished" : "moved";
}

void MapDiffOptions::check() const {
  checkOption(least_points >= kLeastPointsOfSurface, "least_points", least_points, "3 or more");
  checkOption(least_scans >= 0, "least_scans", least_scans, "0 or more");
  checkOption(least_share_of_scans >= 0.0 && least_share_of_scans <= 1.0, "least_share_of_scans", least_share_of_scans,
              "between 0 and 1");
  checkOption(least_displacement_m > 0.0 && std::isfinite(least_displacement_m), "least_displacement_m",
              least_displacement_m, "positive");
  checkOption(least_voxels >= 1, "least_voxels", least_voxels, "1 or more");
}

MapDiff diffMaps(const WeightedVoxelMap& first_map, const WeightedVoxelMap& second_map, const MapDiffOptions& options,
                 int threads) {
  options.check();
  requireComparable(first_map.origin(), second_map.origin());
  Side first(first_map, options, threads), second(second_map, options, threads);
  const Comparison forwards(first, second, options), backwards(second, first, options);
  forEachSurface(first, threads, [&](std::size_t i, const Surface& surface, VoxelIndex::Cursor& cursor) {
    first.same[i] = static_cast<char>(forwards.isSame(surface, cursor));
  });
  forEachSurface(second, threads, [&](std::size_t i, const Surface& surface, VoxelIndex::Cursor& cursor) {
    second.same[i] = static_cast<char>(backwards.isSame(surface, cursor));
  });
  forEachSurface(first, threads, [&](std::size_t i, const Surface& surface, VoxelIndex::Cursor& cursor) {
    if (first.same[i] == 0 && first.compared[i] != 0) first.found[i] = forwards.fate(surface, cursor);
  });
  forEachSurface(second, threads, [&](std::size_t i, const Surface& surface, VoxelIndex::Cursor& cursor) {
    if (second.same[i] == 0 && second.compared[i] != 0) second.found[i] = backwards.fate(surface, cursor);
  });

  std::vector<ChangedVoxel> changes;
  appendChanges(first, false, changes);
  appendChanges(second, true, changes);
  MapDiff diff;
  diff.resolution_m = first_map.resolution();
  diff.options = options;
  GroupedChanges grouped = groupChanges(changes, options.least_voxels, diff.resolution_m);
  diff.first = sumUp(first_map, first, false, grouped.changes);
  diff.second = sumUp(second_map, second, true, grouped.changes);
  measureGaps(first, second, diff);
  diff.changes = std::move(grouped.changes);
  diff.groups = std::move(grouped.groups);
  return diff;
}

}  // namespace saw_ndt
