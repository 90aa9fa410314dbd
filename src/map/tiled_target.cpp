#include "saw_ndt/map/tiled_target.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "common/stopwatch.h"
#include "map/level_plan.h"
#include "map/localization_map_file.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt {

using namespace internal;

namespace {

// So far from where it begins an alignment may look at voxels (m).
constexpr double kAlignmentWay_m = 10.0;

// The middle of a voxel that a point looks at lies within so many edges of it.
constexpr double kVoxelsLookedAt = 2.5;

// What a voxel takes: its cell and its share of the index.
constexpr std::size_t kBytesPerVoxel = sizeof(PackedNdtCell) + 32;

// By so much a radius is cut at a time where memory is bound.
constexpr double kCut = 0.9;

}  // namespace

void TiledTargetOptions::check() const {
  checkOption(radius_m > 0.0 && std::isfinite(radius_m), "radius_m", radius_m, "positive");
  checkOption(hysteresis_m > 0.0 && std::isfinite(hysteresis_m), "hysteresis_m", hysteresis_m, "positive");
  checkOption(lookahead_s > 0.0 && std::isfinite(lookahead_s), "lookahead_s", lookahead_s, "positive");
  checkOption(most_bytes > 0, "most_bytes", static_cast<double>(most_bytes), "positive");
}

TiledTarget::TiledTarget(const NdtTarget& whole) : whole_(whole) {}

TiledTarget::TiledTarget(const LocalizationMap& map, const TiledTargetOptions& options) : options_(options), map_(map) {
  options_.check();
  const TargetPlan plan = planTarget(map.origin(), map.weighting());
  for (const LevelPlan& level : plan.levels) largest_voxel_m_ = std::max(largest_voxel_m_, level.resolution_m);
  if (plan.coarse) largest_voxel_m_ = std::max(largest_voxel_m_, plan.coarse->resolution_m);
}

TiledTarget TiledTarget::open(const std::string& path, const VoxelWeighting& weighting,
                              const TiledTargetOptions& options, int threads) {
  options.check();
  if (!LocalizationMap::isOne(path)) return NdtTarget::load(path, weighting, threads);
  const LocalizationMap map(path);
  map.requireWeighting(weighting);
  return TiledTarget(map, options);
}

const MapOrigin& TiledTarget::origin() const { return whole_ ? whole_->origin() : map_->origin(); }
const VoxelWeighting& TiledTarget::weighting() const { return whole_ ? whole_->weighting() : map_->weighting(); }

double TiledTarget::reach() const { return whole_ ? std::numeric_limits<double>::infinity() : options_.radius_m; }

// A point looks at the voxels around its own.
double TiledTarget::neededReach(double reach_m) const {
  return std::max(options_.radius_m, reach_m) + kAlignmentWay_m + kVoxelsLookedAt * largest_voxel_m_;
}

TiledTarget::Window TiledTarget::planAround(const Eigen::Vector2d& centre_m, double needed_m) const {
  Window plan;
  plan.centre_m = centre_m;
  plan.radius_m = needed_m + options_.hysteresis_m;
  return plan;
}

TiledTarget::Window TiledTarget::loaded(const LocalizationMap& map, Window plan, std::size_t most_bytes, int threads) {
  const Stopwatch stopwatch;
  const LocalizationMapFile& file = map.file();
  std::vector<LocalizationTilePlace> tiles;
  for (plan.loaded_radius_m = plan.radius_m;; plan.loaded_radius_m *= kCut) {
    tiles = file.tilesAround(plan.centre_m, plan.loaded_radius_m);
    std::size_t voxel_count = 0;
    for (const LocalizationTilePlace& tile : tiles) voxel_count += tile.voxel_count;
    if (tiles.size() <= 1 || voxel_count <= most_bytes / kBytesPerVoxel) break;
  }
  plan.target = file.targetOf(tiles, threads, LocalizationClip{plan.centre_m, plan.loaded_radius_m});
  plan.load_ms = stopwatch.milliseconds();
  return plan;
}

void TiledTarget::begin(const Window& plan) {
  ahead_ = Loading{plan, std::async(std::launch::async, [map = *map_, plan, most_bytes = options_.most_bytes] {
                           return loaded(map, plan, most_bytes, 1);
                         }).share()};
}

const NdtTarget& TiledTarget::take(Window window) {
  ++loads_.loads;
  if (loads_.loads == 1) loads_.first_load_ms = window.load_ms;
  loads_.longest_load_ms = std::max(loads_.longest_load_ms, window.load_ms);
  if (window.loaded_radius_m < window.radius_m) {
    loads_.least_radius_m =
        loads_.least_radius_m == 0.0 ? window.loaded_radius_m : std::min(loads_.least_radius_m, window.loaded_radius_m);
  }
  window_ = std::move(window);
  return window_->target;
}

NdtTarget TiledTarget::at(const Eigen::Vector3d& position_m, double reach_m) {
  if (whole_) return *whole_;
  const Eigen::Vector2d position = position_m.head<2>();
  const double needed_m = neededReach(reach_m);
  if (window_ && window_->covers(position, needed_m)) return window_->target;
  const Stopwatch wait;
  const bool is_first = loads_.loads == 0, is_wide = reach_m > options_.radius_m;
  bool waits = true;
  Window window;
  if (ahead_ && ahead_->plan.covers(position, needed_m)) {
    const Loading ahead = *std::exchange(ahead_, std::nullopt);
    waits = ahead.window.wait_for(std::chrono::seconds(0)) != std::future_status::ready;
    window = ahead.window.get();
  } else {
    window_.reset();
    window = loaded(*map_, planAround(position, needed_m), options_.most_bytes, 0);
  }
  if (is_wide) {
    ++loads_.wide_loads;
  } else if (waits && !is_first) {
    ++loads_.waits;
    loads_.longest_wait_ms = std::max(loads_.longest_wait_ms, wait.milliseconds());
  }
  return take(std::move(window));
}

void TiledTarget::loadAhead(const Eigen::Vector3d& position_m, const Eigen::Vector3d& velocity_mps) {
  if (whole_) return;
  const double needed_m = neededReach(options_.radius_m);
  const Eigen::Vector2d position = position_m.head<2>();
  Eigen::Vector2d way = options_.lookahead_s * velocity_mps.head<2>();
  if (!position.allFinite() || !way.allFinite()) return;
  // No further, or tiles around a point ahead would have to be loaded again at once.
  way *= std::min(1.0, options_.hysteresis_m / std::max(way.norm(), 1e-9));
  const Eigen::Vector2d soon = position + way;
  if (window_ && window_->covers(position, needed_m) && window_->covers(soon, needed_m)) return;
  if (ahead_) {
    const bool is_ready = ahead_->window.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    if (!is_ready || ahead_->plan.covers(soon, needed_m)) return;
  }
  // As far ahead as still covers the position: it lasts longest.
  begin(planAround(soon, needed_m));
}

}  // namespace saw_ndt
