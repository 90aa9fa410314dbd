#include "saw_ndt/map/moved_voxels.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <mutex>
#include <stdexcept>
#include <utility>
#include <vector>

#include "map/direction_image.h"
#include "map/moved_decision.h"
#include "map/voxel_patches.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt {

using namespace internal;

namespace {

// Nearer returns are of the vehicle itself.
constexpr float kMinRange_m = 2.5F;
// All rays must end behind that pass within this distance of the mean, in edges of a voxel.
constexpr double kReach = 0.3;
// How far behind rays must end: in edges of a voxel, and a share of the range for errors of the pose.
constexpr double kMargin = 0.5;
constexpr double kMarginShare = 0.01;

/// What is needed to look at voxels from a scan. Memory is kept from one scan to the next.
struct Sight {
  static constexpr std::size_t kBlock = 256;

  DirectionImage image;
  float x[kBlock], y[kBlock], z[kBlock], range_m[kBlock], horizontal_range_m[kBlock];
  std::int32_t pixel[kBlock];
};

/// Sights for those that ask for one at the same time.
class Sights {
 public:
  std::unique_ptr<Sight> take() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (idle_.empty()) return std::make_unique<Sight>();
    std::unique_ptr<Sight> sight = std::move(idle_.back());
    idle_.pop_back();
    return sight;
  }
  void giveBack(std::unique_ptr<Sight> sight) {
    const std::lock_guard<std::mutex> lock(mutex_);
    idle_.push_back(std::move(sight));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<Sight>> idle_;
};

// From a patch's own frame to that of a scan.
RigidTransform3f patchTransform(const Eigen::Isometry3d& T_scan_map, const Eigen::Vector3d& centre_m) {
  const Eigen::Vector3d moved = T_scan_map * centre_m;
  RigidTransform3f T;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) T.row[row][column] = static_cast<float>(T_scan_map(row, column));
    T.row[row][3] = static_cast<float>(moved[row]);
  }
  return T;
}

}  // namespace

void MovedVoxelOptions::check() const {
  checkOption(max_hit_share > 0.0 && max_hit_share <= 0.5, "max_hit_share", max_hit_share, "above 0 and at most 0.5");
  checkOption(max_range_m > 0.0 && std::isfinite(max_range_m), "max_range_m", max_range_m, "positive");
}

class MovedVoxels::Counts {
 public:
  Counts(WeightedVoxelMap whole, const MovedVoxelOptions& options)
      : map(std::move(whole)),
        options_((options.check(), options)),
        voxels_(map.entries(), map.resolution()),
        seen_through_(voxels_.size()) {
    for (const LabelledVoxelSums& entry : map.entries()) {
      if (entry.scan_count == 0) {
        throw std::invalid_argument("the map does not tell how many scans met its voxels: it must be built anew");
      }
    }
  }

  void addScan(const ScanView& scan, const Eigen::Isometry3d& T_map_scan) {
    std::unique_ptr<Sight> sight = sights_.take();
    sight->image.make(scan, kMinRange_m);
    const Eigen::Isometry3d T_scan_map = T_map_scan.inverse();
    for (const VoxelPatches::Patch& patch : voxels_.patches()) {
      if ((patch.centre_m - T_map_scan.translation()).norm() < options_.max_range_m + voxels_.radius()) {
        look(patch, patchTransform(T_scan_map, patch.centre_m), *sight);
      }
    }
    sights_.giveBack(std::move(sight));
  }

  WeightedVoxelMap remaining() const {
    const std::vector<LabelledVoxelSums>& entries = map.entries();
    std::vector<VoxelSightings> sightings(voxels_.size());
    for (std::size_t i = 0; i < sightings.size(); ++i) {
      sightings[i].seen_through = seen_through_[i].load(std::memory_order_relaxed);
      sightings[i].voxel = entries[voxels_.firstEntry(i)].voxel;
      forEachEntry(i, [&](std::size_t entry) { sightings[i].hits += entries[entry].scan_count; });
    }
    const std::vector<std::uint8_t> moved = voxelsThatMoved(sightings, options_.max_hit_share);
    std::vector<bool> goes(entries.size());
    for (std::size_t i = 0; i < moved.size(); ++i) {
      if (moved[i] != 0) forEachEntry(i, [&](std::size_t entry) { goes[entry] = true; });
    }
    std::vector<LabelledVoxelSums> kept;
    MapOrigin origin = map.origin();
    for (std::size_t i = 0; i < entries.size(); ++i) {
      if (goes[i]) {
        origin.point_count -= entries[i].sums.count;
      } else {
        kept.push_back(entries[i]);
      }
    }
    return {origin, std::move(kept)};
  }

  const WeightedVoxelMap map;

 private:
  // Calls visit(entry) for each entry of a voxel that may go.
  template <typename Visit>
  void forEachEntry(std::size_t voxel, const Visit& visit) const {
    const std::vector<LabelledVoxelSums>& entries = map.entries();
    const std::size_t first = voxels_.firstEntry(voxel);
    for (std::size_t i = first; i < entries.size() && entries[i].voxel == entries[first].voxel; ++i) {
      if (entries[i].label != StructuralLabel::GROUND) visit(i);
    }
  }

  // Counts the voxels of a patch that are seen through.
  void look(const VoxelPatches::Patch& patch, const RigidTransform3f& T_scan_patch, Sight& sight) {
    const auto edge_m = static_cast<float>(map.resolution());
    const float reach = static_cast<float>(kReach) * edge_m * DirectionImage::kPixelsPerRadian;
    const float margin_m = static_cast<float>(kMargin) * edge_m;
    const auto factor = static_cast<float>(1.0 + kMarginShare);
    const DirectionGrid grid = DirectionImage::grid(kMinRange_m, static_cast<float>(options_.max_range_m));
    for (std::size_t first = patch.first; first < patch.last; first += Sight::kBlock) {
      const std::size_t count = std::min(Sight::kBlock, patch.last - first);
      transformPoints(count, voxels_.means(first), T_scan_patch, sight.x, sight.y, sight.z);
      measureDirections(count, {sight.x, sight.y, sight.z}, grid,
                        {sight.range_m, sight.horizontal_range_m, sight.pixel});
      for (std::size_t i = 0; i < count; ++i) {
        if (sight.pixel[i] < 0) continue;
        const float least_m = factor * sight.range_m[i] + margin_m;
        if (sight.image.endsBeyond(sight.pixel[i], least_m, reach / sight.horizontal_range_m[i])) {
          seen_through_[first + i].fetch_add(1, std::memory_order_relaxed);
        }
      }
    }
  }

  const MovedVoxelOptions options_;
  const VoxelPatches voxels_;
  std::vector<std::atomic<std::uint32_t>> seen_through_;
  Sights sights_;
};

MovedVoxels::MovedVoxels(WeightedVoxelMap map, const MovedVoxelOptions& options)
    : counts_(std::make_unique<Counts>(std::move(map), options)) {}
MovedVoxels::~MovedVoxels() = default;
MovedVoxels::MovedVoxels(MovedVoxels&&) noexcept = default;
MovedVoxels& MovedVoxels::operator=(MovedVoxels&&) noexcept = default;

const WeightedVoxelMap& MovedVoxels::map() const { return counts_->map; }

void MovedVoxels::addScan(const ScanView& scan, const Eigen::Isometry3d& T_map_scan) {
  if (!T_map_scan.matrix().allFinite()) throw std::invalid_argument("T_map_scan is not finite");
  counts_->addScan(scan, T_map_scan);
}

WeightedVoxelMap MovedVoxels::remaining() const { return counts_->remaining(); }

}  // namespace saw_ndt
