#include "saw_ndt/map/ndt_target.h"

#include <cstddef>
#include <numeric>
#include <optional>
#include <utility>

#include "common/executor.h"
#include "map/coarse_sums.h"
#include "map/level_plan.h"
#include "map/map_file.h"
#include "map/ndt_level.h"
#include "map/sums_statistics.h"
#include "saw_ndt/map/localization_map.h"

namespace saw_ndt {

using namespace internal;

namespace {

double metresPerStep(const MapOrigin& origin) { return origin.resolution_m / kStepsPerVoxel; }

// The levels of a plan, the coarse one last, with sums of larger voxels than the map's where they need them.
struct PlannedLevel {
  LevelPlan plan;
  std::optional<CoarseSums> sums;
};

std::vector<PlannedLevel> plannedLevels(const TargetPlan& plan) {
  std::vector<PlannedLevel> planned;
  const auto add = [&planned](const LevelPlan& level) {
    PlannedLevel& added = planned.emplace_back();
    added.plan = level;
    if (level.factor > 1) added.sums.emplace(level.factor);
  };
  for (const LevelPlan& level : plan.levels) add(level);
  if (plan.coarse) add(*plan.coarse);
  return planned;
}

// What comes of a part of a file.
struct DerivedPart {
  NdtCells cells;  // of the map's own voxels
  std::vector<PlannedLevel> levels;
};

// Makes what there is to make of each part of a piece. The error of the first part that is damaged is thrown.
void derive(MapFileReader& reader, const MapPiece& piece, const VoxelWeighting& weighting, int threads,
            std::vector<DerivedPart>& derived) {
  std::vector<std::vector<LabelledVoxelSums>> entries_of_worker(
      static_cast<std::size_t>(internal::threadCount(threads)));
  internal::forEachChunk(threads, piece.parts.size(), [&](std::size_t i, int worker) {
    DerivedPart& part = derived[i];
    std::vector<LabelledVoxelSums>& entries = entries_of_worker[static_cast<std::size_t>(worker)];
    reader.decode(piece.parts[i], entries);
    const LabelledVoxelSums* const first = entries.data();
    const LabelledVoxelSums* const last = first + entries.size();
    for (PlannedLevel& level : part.levels) {
      if (level.sums) {
        level.sums->add(first, last);
      } else {
        internal::forEachStatistics(first, last, weighting, level.plan, metresPerStep(reader.origin()),
                                    [&part](const std::vector<VoxelStatistics>& statistics) {
                                      part.cells.add(statistics, CellPrecision::SINGLE);
                                    });
      }
    }
  });
}

NdtLevel levelOf(PlannedLevel& level, const MapOrigin& origin, const VoxelWeighting& weighting, CellPrecision precision,
                 int threads) {
  return NdtLevel::fromSums(level.sums->takeInMapOrder(), level.plan, weighting, metresPerStep(origin), precision,
                            threads);
}

}  // namespace

struct NdtTarget::Levels {
  MapOrigin origin;
  VoxelWeighting weighting;
  std::vector<NdtLevel> matching = std::vector<NdtLevel>(1);  // the finest first
  NdtLevel coarse;

  // Takes the levels of a plan over.
  void take(const TargetPlan& plan, std::vector<NdtLevel> levels) {
    if (plan.coarse) {
      coarse = std::move(levels.back());
      levels.pop_back();
    }
    matching = std::move(levels);
  }
};

NdtTarget::NdtTarget() {
  static const auto empty = std::make_shared<const Levels>();
  levels_ = empty;
}

NdtTarget::NdtTarget(const WeightedVoxelMap& map, const VoxelWeighting& weighting, int threads,
                     CellPrecision precision) {
  weighting.check();
  const TargetPlan plan = planTarget(map.origin(), weighting);
  std::vector<PlannedLevel> planned = plannedLevels(plan);
  std::vector<NdtLevel> made(planned.size());
  const std::vector<LabelledVoxelSums>& entries = map.entries();
  internal::forEachChunk(threads, planned.size(), [&](std::size_t i, int) {
    if (!planned[i].sums) return;
    planned[i].sums->add(entries.data(), entries.data() + entries.size());
    made[i] = levelOf(planned[i], map.origin(), weighting, precision, 1);
  });
  for (std::size_t i = 0; i < planned.size(); ++i) {
    if (planned[i].sums) continue;
    made[i] = NdtLevel::fromSums(entries, planned[i].plan, weighting, metresPerStep(map.origin()), precision, threads);
  }
  levels_ = ofLevels(map.origin(), weighting, std::move(made)).levels_;
}

NdtTarget NdtTarget::load(const std::string& path, const VoxelWeighting& weighting, int threads) {
  weighting.check();
  if (LocalizationMap::isOne(path)) {
    const LocalizationMap map(path);
    map.requireWeighting(weighting);
    return map.target(threads);
  }
  MapFileReader reader(path);
  const TargetPlan plan = planTarget(reader.origin(), weighting);
  std::vector<PlannedLevel> planned = plannedLevels(plan);
  NdtCells cells;
  // More than are needed, since voxels have several labels; what is not written to takes no memory.
  if (plan.levels.front().factor == 1) cells.reserve(reader.entryCount());
  MapPiece piece;
  std::vector<DerivedPart> derived;
  while (reader.readPiece(piece)) {
    derived.clear();
    derived.resize(piece.parts.size(), {{}, plannedLevels(plan)});
    derive(reader, piece, weighting, threads, derived);
    for (DerivedPart& part : derived) {
      cells.append(std::move(part.cells));
      for (std::size_t i = 0; i < planned.size(); ++i) {
        if (planned[i].sums) planned[i].sums->add(*part.levels[i].sums);
      }
    }
  }
  std::vector<NdtLevel> made(planned.size());
  // Side by side.
  internal::forEachChunk(threads, planned.size(), [&](std::size_t i, int) {
    made[i] = planned[i].sums ? levelOf(planned[i], reader.origin(), weighting, CellPrecision::SINGLE, 1)
                              : NdtLevel(planned[i].plan.resolution_m, std::move(cells));
  });
  return ofLevels(reader.origin(), weighting, std::move(made));
}

NdtTarget NdtTarget::ofLevels(const MapOrigin& origin, const VoxelWeighting& weighting, std::vector<NdtLevel> levels) {
  auto made = std::make_shared<Levels>();
  made->origin = origin;
  made->weighting = weighting;
  made->take(planTarget(origin, weighting), std::move(levels));
  return NdtTarget(std::move(made));
}

const MapOrigin& NdtTarget::origin() const { return levels_->origin; }
const VoxelWeighting& NdtTarget::weighting() const { return levels_->weighting; }
double NdtTarget::resolution() const { return fine().resolution(); }
std::size_t NdtTarget::voxelCount() const {
  return std::accumulate(levels().begin(), levels().end(), std::size_t{0},
                         [](std::size_t count, const NdtLevel& level) { return count + level.size(); });
}
std::size_t NdtTarget::coarseVoxelCount() const { return coarse().size(); }
std::vector<Eigen::Vector3d> NdtTarget::means() const {
  std::vector<Eigen::Vector3d> all;
  for (const NdtLevel& level : levels()) {
    const std::vector<Eigen::Vector3d> means = level.means();
    all.insert(all.end(), means.begin(), means.end());
  }
  return all;
}
const std::vector<internal::NdtLevel>& NdtTarget::levels() const { return levels_->matching; }
const internal::NdtLevel& NdtTarget::fine() const { return levels_->matching.front(); }
const internal::NdtLevel& NdtTarget::coarse() const { return levels_->coarse; }

}  // namespace saw_ndt
