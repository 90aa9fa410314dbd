#include "map/ndt_level.h"

#include <Eigen/LU>
#include <algorithm>
#include <exception>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <utility>

#include "common/executor.h"
#include "map/merged_voxel.h"
#include "map/voxel_sums_table.h"

namespace saw_ndt {
namespace {

int floorDivide(int value, int divisor) {
  const int quotient = value / divisor;
  return value % divisor < 0 ? quotient - 1 : quotient;
}

// The sums of a child voxel about the centre of the voxel of `factor` times its size that holds it.
LabelledVoxelSums inParent(const LabelledVoxelSums& child, int factor) {
  LabelledVoxelSums parent{VoxelCoordinate::Zero(), child.label, {}};
  std::array<std::int64_t, 3> shift;
  for (int axis = 0; axis < 3; ++axis) {
    parent.voxel[axis] = floorDivide(child.voxel[axis], factor);
    const std::int64_t place =
        static_cast<std::int64_t>(child.voxel[axis]) - static_cast<std::int64_t>(parent.voxel[axis]) * factor;
    shift[static_cast<std::size_t>(axis)] = (2 * place + 1 - factor) * (kStepsPerVoxel / 2);
  }
  parent.sums = child.sums.shifted(shift);
  return parent;
}

// Puts labels of a voxel together: those that take part, while points are counted by label.
class LabelMerger {
 public:
  explicit LabelMerger(const ConfidenceOptions& confidence) {
    for (std::size_t label = 0; label < confidence_.size(); ++label) {
      confidence_[label] = confidence.of(static_cast<StructuralLabel>(label));
    }
  }

  using Counts = std::array<std::uint64_t, kStructuralLabelCount>;

  bool takesPart(StructuralLabel label) const { return confidence_[static_cast<std::size_t>(label)] > 0.0; }

  MergedVoxel merged(const VoxelCoordinate& voxel, const VoxelSums& sums, const Counts& counts) const {
    double confidence_sum = 0.0;
    for (std::size_t label = 0; label < counts.size(); ++label) {
      confidence_sum += confidence_[label] * static_cast<double>(counts[label]);
    }
    return {voxel, sums, confidence_sum / static_cast<double>(sums.count)};
  }

 private:
  std::array<double, kStructuralLabelCount> confidence_;
};

// The next voxels, a batch at most, of entries `first` to `last`, which hold the entries of a voxel one after the
// other. Moves `first` behind them.
void mergeLabels(const LabelledVoxelSums*& first, const LabelledVoxelSums* last, const LabelMerger& merger,
                 std::vector<MergedVoxel>& voxels) {
  constexpr std::size_t kBatch = 256;
  voxels.clear();
  while (first != last && voxels.size() < kBatch) {
    const VoxelCoordinate& voxel = first->voxel;
    VoxelSums sums;
    LabelMerger::Counts counts{};
    for (; first != last && first->voxel == voxel; ++first) {
      if (!merger.takesPart(first->label)) continue;
      sums += first->sums;
      counts[static_cast<std::size_t>(first->label)] = first->sums.count;
    }
    if (sums.count > 0) voxels.push_back(merger.merged(voxel, sums, counts));
  }
}

// The voxels of `factor` times the size, in the order in which the first entry of each is met.
std::vector<MergedVoxel> mergeChildren(const std::vector<LabelledVoxelSums>& entries, int factor,
                                       const LabelMerger& merger) {
  VoxelSumsTable table;
  std::vector<LabelMerger::Counts> counts;
  for (const LabelledVoxelSums& entry : entries) {
    if (!merger.takesPart(entry.label)) continue;
    const LabelledVoxelSums parent = inParent(entry, factor);
    // Labels are put together here and now: all go under one.
    const std::size_t place = table.placeOf(parent.voxel, StructuralLabel::NonGround);
    table.sums(place) += parent.sums;
    if (place == counts.size()) counts.push_back({});
    counts[place][static_cast<std::size_t>(entry.label)] += parent.sums.count;
  }
  std::vector<MergedVoxel> voxels;
  voxels.reserve(counts.size());
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const LabelledVoxelSums& entry = table.entries()[i];
    voxels.push_back(merger.merged(entry.voxel, entry.sums, counts[i]));
  }
  return voxels;
}

// What `append(first, last, part)` appends of 0 to `count`, put together in order, by several threads.
template <typename Append>
std::vector<VoxelStatistics> inParts(std::size_t count, int threads, const Append& append) {
  constexpr std::size_t kLeastPerThread = 1000;
  const std::size_t part_count =
      std::clamp<std::size_t>(count / kLeastPerThread, 1, static_cast<std::size_t>(internal::threadCount(threads)));
  std::vector<std::vector<VoxelStatistics>> parts(part_count);
  std::exception_ptr failure;
#pragma omp parallel for num_threads(static_cast <int>(part_count)) schedule(static)
  for (std::size_t p = 0; p < part_count; ++p) {
    try {
      append(count * p / part_count, count * (p + 1) / part_count, parts[p]);
    } catch (...) {
#pragma omp critical
      failure = std::current_exception();
    }
  }
  if (failure) std::rethrow_exception(failure);
  std::vector<VoxelStatistics> whole = std::move(parts.front());
  for (std::size_t p = 1; p < part_count; ++p) whole.insert(whole.end(), parts[p].begin(), parts[p].end());
  return whole;
}

}  // namespace

PackedNdtCell::PackedNdtCell(const NdtCell& cell)
    : weight(static_cast<float>(cell.weight)), mean_confidence(static_cast<float>(cell.mean_confidence)) {
  const auto to_single = [](double value) { return static_cast<float>(value); };
  std::transform(std::begin(cell.mean_from_centre), std::end(cell.mean_from_centre), mean_from_centre, to_single);
  std::transform(std::begin(cell.inverse_covariance), std::end(cell.inverse_covariance), inverse_covariance, to_single);
}

NdtLevel::NdtLevel(double resolution_m, const std::vector<VoxelStatistics>& voxels) : resolution_m_(resolution_m) {
  if (voxels.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    throw std::length_error("a map level cannot hold more than 2147483647 voxels");
  }
  cells_.reserve(voxels.size());
  voxels_.reserve(voxels.size());
  point_counts_.reserve(voxels.size());
  structure_classes_.reserve(voxels.size());
  for (const VoxelStatistics& v : voxels) {
    const Eigen::Vector3d& mean = v.mean_from_centre;
    const Eigen::Matrix3d& inverse = v.inverse_covariance;
    cells_.push_back({{mean.x(), mean.y(), mean.z()},
                      {inverse(0, 0), inverse(0, 1), inverse(0, 2), inverse(1, 1), inverse(1, 2), inverse(2, 2)},
                      v.weight,
                      v.mean_confidence});
    voxels_.push_back(v.voxel);
    point_counts_.push_back(v.point_count);
    structure_classes_.push_back(v.structure_class);
  }
  packed_cells_ = std::vector<PackedNdtCell>(cells_.begin(), cells_.end());
  index_ = VoxelIndex(voxels_);
}

NdtLevel NdtLevel::fromSums(const std::vector<LabelledVoxelSums>& entries, double resolution_m, int factor,
                            const VoxelWeighting& weighting, int threads) {
  const LabelMerger merger(weighting.confidence);
  const double metres_per_step = resolution_m / kStepsPerVoxel;
  using Part = std::vector<VoxelStatistics>;
  if (factor > 1) {
    const std::vector<MergedVoxel> parents = mergeChildren(entries, factor, merger);
    const auto append = [&](std::size_t first, std::size_t last, Part& part) {
      appendVoxelStatistics(parents.data() + first, last - first, weighting, metres_per_step, part);
    };
    return NdtLevel(resolution_m * factor, inParts(parents.size(), threads, append));
  }
  const auto startOfVoxel = [&](std::size_t i) {
    while (i > 0 && i < entries.size() && entries[i].voxel == entries[i - 1].voxel) ++i;
    return entries.data() + i;
  };
  const auto append = [&](std::size_t first, std::size_t last, Part& part) {
    std::vector<MergedVoxel> voxels;
    const LabelledVoxelSums* next = startOfVoxel(first);
    const LabelledVoxelSums* const end = startOfVoxel(last);
    while (next != end) {
      mergeLabels(next, end, merger, voxels);
      appendVoxelStatistics(voxels.data(), voxels.size(), weighting, metres_per_step, part);
    }
  };
  return NdtLevel(resolution_m, inParts(entries.size(), threads, append));
}

VoxelStatistics NdtLevel::voxel(std::size_t i) const {
  const NdtCell& cell = cells_.at(i);
  VoxelStatistics statistics;
  statistics.voxel = voxels_[i];
  statistics.point_count = point_counts_[i];
  statistics.mean_from_centre = Eigen::Map<const Eigen::Vector3d>(cell.mean_from_centre);
  const double* c = cell.inverse_covariance;
  statistics.inverse_covariance << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
  statistics.covariance = statistics.inverse_covariance.inverse();
  statistics.mean_confidence = cell.mean_confidence;
  statistics.structure_class = structure_classes_[i];
  statistics.weight = cell.weight;
  return statistics;
}

std::int32_t NdtLevel::find(const Eigen::Vector3d& position_m) const {
  QuantizedPosition position;
  if (!quantize(position_m, 1.0 / resolution_m_, position)) return VoxelIndex::kNone;
  return index_.find(position.voxel);
}

}  // namespace saw_ndt
