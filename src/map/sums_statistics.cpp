#include "map/sums_statistics.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "common/executor.h"
#include "map/merged_voxel.h"

namespace saw_ndt::internal {
namespace {

// Puts labels of a voxel together: those that take part, while points are counted by label.
class LabelMerger {
 public:
  explicit LabelMerger(const ConfidenceOptions& confidence) {
    for (std::size_t label = 0; label < confidence_.size(); ++label) {
      confidence_[label] = confidence.of(static_cast<StructuralLabel>(label));
    }
  }

  // Takes the next voxels, a batch at most, and moves `first` behind their entries.
  void take(const LabelledVoxelSums*& first, const LabelledVoxelSums* last, std::vector<MergedVoxel>& voxels) const {
    constexpr std::size_t kBatch = 256;
    voxels.clear();
    while (first != last && voxels.size() < kBatch) {
      MergedVoxel voxel;
      voxel.voxel = first->voxel;
      std::array<std::uint64_t, kStructuralLabelCount> counts{};
      for (; first != last && first->voxel == voxel.voxel; ++first) {
        const auto label = static_cast<std::size_t>(first->label);
        if (!(confidence_[label] > 0.0)) continue;
        voxel.sums += first->sums;
        voxel.scan_count = std::max(voxel.scan_count, first->scan_count);
        counts[label] = first->sums.count;
      }
      if (voxel.sums.count == 0) continue;
      double confidence_sum = 0.0;
      for (std::size_t label = 0; label < counts.size(); ++label) {
        confidence_sum += confidence_[label] * static_cast<double>(counts[label]);
      }
      voxel.mean_confidence = confidence_sum / static_cast<double>(voxel.sums.count);
      voxel.ground_share = static_cast<double>(counts[static_cast<std::size_t>(StructuralLabel::GROUND)]) /
                           static_cast<double>(voxel.sums.count);
      voxels.push_back(voxel);
    }
  }

 private:
  std::array<double, kStructuralLabelCount> confidence_;
};

}  // namespace

void forEachStatistics(const LabelledVoxelSums* first, const LabelledVoxelSums* last, const VoxelWeighting& weighting,
                       const LevelPlan& level, double metres_per_step,
                       const std::function<void(const std::vector<VoxelStatistics>&)>& visit) {
  const LabelMerger merger(weighting.confidence);
  std::vector<MergedVoxel> voxels;
  std::vector<VoxelStatistics> statistics;
  while (first != last) {
    merger.take(first, last, voxels);
    statistics.clear();
    appendVoxelStatistics(voxels.data(), voxels.size(), weighting, level, metres_per_step, statistics);
    visit(statistics);
  }
}

std::uint64_t voxelCountOf(const LabelledVoxelSums* first, const LabelledVoxelSums* last, double resolution_m) {
  std::uint64_t count = 0;
  forEachStatistics(first, last, {}, {}, resolution_m / kStepsPerVoxel,
                    [&count](const std::vector<VoxelStatistics>& batch) { count += batch.size(); });
  return count;
}

std::uint64_t pointCountOf(const LabelledVoxelSums* first, const LabelledVoxelSums* last) {
  return std::accumulate(first, last, std::uint64_t{0},
                         [](std::uint64_t count, const LabelledVoxelSums& entry) { return count + entry.sums.count; });
}

void forEachPartOfVoxels(const std::vector<LabelledVoxelSums>& entries, int threads,
                         const std::function<void(std::size_t part_count)>& prepare,
                         const std::function<void(std::size_t part, const LabelledVoxelSums* first,
                                                  const LabelledVoxelSums* last)>& process) {
  constexpr std::size_t kMinPerThread = 1000;
  const std::size_t part_count =
      std::clamp<std::size_t>(entries.size() / kMinPerThread, 1, static_cast<std::size_t>(threadCount(threads)));
  prepare(part_count);
  const auto startOf = [&](std::size_t part) {
    std::size_t i = entries.size() * part / part_count;
    while (i > 0 && i < entries.size() && entries[i].voxel == entries[i - 1].voxel) ++i;
    return entries.data() + i;
  };
  forEachChunk(threads, part_count, [&](std::size_t part, int) { process(part, startOf(part), startOf(part + 1)); });
}

}  // namespace saw_ndt::internal
