#include "map/merge_rules.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

#include "map/map_metadata.h"
#include "map/voxel_sums_table.h"
#include "saw_ndt/common/error.h"
#include "segmentation/segmentation_fields.h"

namespace saw_ndt::internal {
namespace {

void requireSameSegmentation(const std::optional<SegmentationOptions>& into,
                             const std::optional<SegmentationOptions>& from) {
  if (into.has_value() != from.has_value()) {
    throw std::invalid_argument("segmentation: known of one of the maps to merge and not known of the other");
  }
  if (!into) return;
  if (const auto difference = firstDifference(*into, *from)) {
    throw std::invalid_argument("segmentation: the maps to merge differ in " + difference->field + ", which is " +
                                difference->first + " in one and " + difference->second + " in the other");
  }
}

}  // namespace

void requireMergeable(const MapOrigin& into, bool into_holds, const MapOrigin& from, bool from_holds) {
  checkOption(from.resolution_m == into.resolution_m, "resolution_m", fieldText(from.resolution_m),
              ("that of the map merged into, " + fieldText(into.resolution_m)).c_str());
  if (from_holds && into_holds && into.labelled != from.labelled) {
    throw std::invalid_argument("a map holds either labelled or unlabelled clouds, not both");
  }
  requireSameSegmentation(into.segmentation, from.segmentation);
  if (!from_holds) return;
  // An empty map that says nothing of its origin takes one over.
  const bool takes_over = !into_holds && into.map_origin_m.isZero(0.0);
  checkOption(takes_over || from.map_origin_m == into.map_origin_m, "map_origin_m", positionText(from.map_origin_m),
              ("that of the map merged into, " + positionText(into.map_origin_m)).c_str());
  if (from.scan_count > std::numeric_limits<std::uint64_t>::max() - into.scan_count) {
    throw std::invalid_argument("scan_count: more scans than can be counted");
  }
}

void beginAdding(MapOrigin& into, bool into_holds, bool labelled, const std::string& software_version) {
  if (!into_holds) {
    into.labelled = labelled;
    into.software_version = software_version;
  } else if (into.software_version != software_version) {
    into.software_version.clear();
  }
}

void addOrigin(MapOrigin& into, bool into_holds, const MapOrigin& from) {
  beginAdding(into, into_holds, from.labelled, from.software_version);
  into.map_origin_m = from.map_origin_m;
  into.scan_count += from.scan_count;
  into.point_count += from.point_count;
}

void addScanCount(const LabelledVoxelSums& from, LabelledVoxelSums& into) {
  if (into.sums.count == 0) {
    into.scan_count = from.scan_count;
  } else if (into.scan_count == 0 || from.scan_count == 0) {
    into.scan_count = 0;
  } else {
    const std::uint64_t scan_count = std::uint64_t{into.scan_count} + from.scan_count;
    into.scan_count = static_cast<std::uint32_t>(std::min<std::uint64_t>(scan_count, kMostScansOfVoxel));
  }
}

void requireRoomFor(const VoxelSums& from, const VoxelSums& into) {
  if (into.count + from.count > VoxelSums::kMostPoints) {
    throw std::invalid_argument("a voxel would hold more than 2^33 points");
  }
}

}  // namespace saw_ndt::internal
