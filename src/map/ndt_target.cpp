#include "saw_ndt/map/ndt_target.h"

#include <cstddef>
#include <utility>

#include "common/executor.h"
#include "map/coarse_sums.h"
#include "map/map_file.h"
#include "map/ndt_level.h"
#include "map/sums_statistics.h"

namespace saw_ndt {

using namespace internal;

namespace {

using internal::CoarseSums;
using internal::MapFileReader;
using internal::MapPart;
using internal::MapPiece;
using internal::NdtCells;
using internal::NdtLevel;

double metresPerStep(const MapOrigin& origin) { return origin.resolution_m / kStepsPerVoxel; }

NdtLevel coarseLevel(CoarseSums& sums, const MapOrigin& origin, const VoxelWeighting& weighting,
                     CellPrecision precision, int threads) {
  return NdtLevel::fromSums(sums.takeInMapOrder(), origin.resolution_m * weighting.coarse_factor, weighting,
                            metresPerStep(origin), precision, threads);
}

// What comes of a part of a file.
struct DerivedPart {
  explicit DerivedPart(const VoxelWeighting& weighting) : coarse(weighting.coarse_factor) {}
  NdtCells cells;
  CoarseSums coarse;
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
    internal::forEachStatistics(
        first, last, weighting, metresPerStep(reader.origin()),
        [&part](const std::vector<VoxelStatistics>& statistics) { part.cells.add(statistics, CellPrecision::SINGLE); });
    if (weighting.coarse_factor > 1) part.coarse.add(first, last);
  });
}

}  // namespace

struct NdtTarget::Levels {
  MapOrigin origin;
  VoxelWeighting weighting;
  NdtLevel fine;
  NdtLevel coarse;
};

NdtTarget::NdtTarget() {
  static const auto empty = std::make_shared<const Levels>();
  levels_ = empty;
}

NdtTarget::NdtTarget(const WeightedVoxelMap& map, const VoxelWeighting& weighting, int threads,
                     CellPrecision precision) {
  weighting.check();
  auto levels = std::make_shared<Levels>();
  levels->origin = map.origin();
  levels->weighting = weighting;
  levels->fine =
      NdtLevel::fromSums(map.entries(), map.resolution(), weighting, metresPerStep(map.origin()), precision, threads);
  if (weighting.coarse_factor > 1) {
    CoarseSums sums(weighting.coarse_factor);
    sums.add(map.entries().data(), map.entries().data() + map.entries().size());
    levels->coarse = coarseLevel(sums, map.origin(), weighting, precision, threads);
  }
  levels_ = std::move(levels);
}

NdtTarget NdtTarget::load(const std::string& path, const VoxelWeighting& weighting, int threads) {
  weighting.check();
  MapFileReader reader(path);
  NdtCells cells;
  // More than are needed, since voxels have several labels; what is not written to takes no memory.
  cells.reserve(reader.entryCount());
  CoarseSums coarse(weighting.coarse_factor);
  MapPiece piece;
  std::vector<DerivedPart> derived;
  while (reader.readPiece(piece)) {
    derived.clear();
    derived.resize(piece.parts.size(), DerivedPart(weighting));
    derive(reader, piece, weighting, threads, derived);
    for (DerivedPart& part : derived) {
      cells.append(std::move(part.cells));
      coarse.add(part.coarse);
    }
  }
  auto levels = std::make_shared<Levels>();
  levels->origin = reader.origin();
  levels->weighting = weighting;
  // Side by side.
  internal::forEachChunk(threads, 2, [&](std::size_t level, int) {
    if (level == 0) {
      levels->fine = NdtLevel(reader.origin().resolution_m, std::move(cells));
    } else if (weighting.coarse_factor > 1) {
      levels->coarse = coarseLevel(coarse, reader.origin(), weighting, CellPrecision::SINGLE, 1);
    }
  });
  return NdtTarget(std::move(levels));
}

const MapOrigin& NdtTarget::origin() const { return levels_->origin; }
const VoxelWeighting& NdtTarget::weighting() const { return levels_->weighting; }
std::size_t NdtTarget::voxelCount() const { return levels_->fine.size(); }
std::size_t NdtTarget::coarseVoxelCount() const { return levels_->coarse.size(); }
std::vector<Eigen::Vector3d> NdtTarget::means() const { return levels_->fine.means(); }
const internal::NdtLevel& NdtTarget::fine() const { return levels_->fine; }
const internal::NdtLevel& NdtTarget::coarse() const { return levels_->coarse; }

}  // namespace saw_ndt
