#include "registration/levelled_source.h"

#include <algorithm>
#include <array>

#include "common/executor.h"
#include "map/level_plan.h"
#include "map/ndt_level.h"
#include "registration/batch_voxel_finder.h"

namespace saw_ndt::internal {
namespace {

// Finds the level of each run of points whose voxels of the finest level are known. A voxel of each level holds two to
// the power of three of the one before.
class LevelFinder {
 public:
  LevelFinder(const std::vector<NdtLevel>& levels, std::size_t first) : levels_(levels), first_(first) {}

  std::uint8_t levelAt(const VoxelCoordinate& finest) {
    const std::size_t last = levels_.size() - 1;
    for (std::size_t level = first_; level < last; ++level) {
      const auto shift = static_cast<int>(level);
      const VoxelCoordinate voxel(finest.x() >> shift, finest.y() >> shift, finest.z() >> shift);
      const VoxelIndex::Place place = levels_[level].index().place(voxel, cursors_[level]);
      if (place && place.number(0, 0, 0) != VoxelIndex::kNone) return static_cast<std::uint8_t>(level);
    }
    return static_cast<std::uint8_t>(last);
  }

 private:
  const std::vector<NdtLevel>& levels_;
  std::size_t first_;
  std::array<VoxelIndex::Cursor, kMostLevels> cursors_;
};

}  // namespace

void LevelledSource::assign(const NdtTarget& target, OrderedSource& source, const Eigen::Isometry3d& T_map_source,
                            std::size_t first_level, bool ground_apart, int threads, BatchWorkspace& workspace) {
  const std::vector<NdtLevel>& levels = target.levels();
  level_count_ = levels.size();
  part_of_point_.assign(source.size(), static_cast<std::uint8_t>(level_count_ - 1));
  if (VoxelPairs::reachable(levels.front(), T_map_source)) {
    const BatchVoxelFinder finder(levels.front(), NeighborhoodSearchMethod::DIRECT1, T_map_source);
    workspace.prepare(threads);
    forEachChunk(threads, (source.size() + kPointsPerBatch - 1) / kPointsPerBatch, [&](std::size_t batch, int worker) {
      BatchScratch& scratch = *workspace.scratch_of_worker[static_cast<std::size_t>(worker)];
      const std::size_t first = batch * kPointsPerBatch;
      finder.place(source, first, std::min(kPointsPerBatch, source.size() - first), scratch);
      LevelFinder level_finder(levels, first_level);
      const BatchPoints& points = scratch.points;
      for (std::size_t run = 0; run < points.run_count; ++run) {
        const auto begin = static_cast<std::size_t>(points.run_starts[run]);
        const auto end = static_cast<std::size_t>(points.run_starts[run + 1]);
        const VoxelCoordinate voxel =
            VoxelCoordinate(points.voxel[0][begin], points.voxel[1][begin], points.voxel[2][begin]) + finder.origin();
        std::fill(part_of_point_.data() + first + begin, part_of_point_.data() + first + end,
                  level_finder.levelAt(voxel));
      }
    });
  }
  if (ground_apart) {
    const float* const non_ground = source.nonGround();
    for (std::size_t i = 0; i < part_of_point_.size(); ++i) {
      part_of_point_[i] = static_cast<std::uint8_t>(part_of_point_[i] + (non_ground[i] > 0.0F ? 0 : level_count_));
    }
  }
  source.split(part_of_point_, ground_apart ? 2 * level_count_ : level_count_, threads, parts_);
}

std::size_t LevelledSource::nonGroundCount() const {
  std::size_t count = 0;
  for (const OrderedSource& source : parts_) count += source.nonGroundCount();
  return count;
}

}  // namespace saw_ndt::internal
