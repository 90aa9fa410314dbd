#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/map/localization_map.h"
#include "saw_ndt/map/ndt_target.h"
#include "saw_ndt/registration/source_points.h"

namespace saw_ndt {

struct SAW_NDT_EXPORT GlobalSearchOptions {
  std::size_t cells = 304;        ///< of a scan that are looked up, at most; a multiple of 8, 8 to 504
  double heading_step_deg = 2.0;  ///< between the headings tried (degrees)
  std::size_t candidates = 12;    ///< poses that are returned, at most
  double least_share = 0.25;      ///< of the cells that a candidate finds in the map, at least

  /// Throws std::invalid_argument that names the field and its value.
  void check() const;
};

/// Where a vehicle may be, as far as that is known.
struct SearchRegion {
  Eigen::Isometry3d T_map_base = Eigen::Isometry3d::Identity();
  double radius_m = 0.0;     ///< horizontally
  double heading_deg = 180;  ///< the greatest difference of heading
};

/// A pose at which a scan may have been taken.
struct PoseCandidate {
  Eigen::Isometry3d T_map_base = Eigen::Isometry3d::Identity();  ///< to a metre and a few degrees; upright
  double matched_share = 0.0;                                    ///< of the cells of the scan that the map has as well
};

/// Finds where in a map a scan was taken when nobody knows. A scan is turned into cells of 1 m that hold points which
/// are not ground, by their height above it; so position and heading in the plane are all that is unknown. Every place
/// with ground in the map and every heading is tried: how many cells of the scan meet one of the map is counted for
/// hundreds of places at once, bit by bit, which is faster than to bound and leave out. Immutable, cheap to copy
/// since copies share the index, and safe to search from many threads.
class SAW_NDT_EXPORT GlobalSearch {
 public:
  /// @param target  of a map whose ground is about level underfoot and whose z axis points up
  /// @throws std::invalid_argument where an option does not hold
  explicit GlobalSearch(const NdtTarget& target, const GlobalSearchOptions& options = {});
  /// In a localization map, by the tables that it has: those of a region are read when that is searched, and those of
  /// all of it in parts.
  explicit GlobalSearch(const LocalizationMap& map, const GlobalSearchOptions& options = {});

  /// The poses at which most of a scan is found in the map, the best first: each another place or heading.
  /// @param source   in the frame of the base, which is about upright; labels help
  /// @param region   nothing: everywhere
  /// @throws Error where a table of a localization map is damaged, std::invalid_argument where a point of the source is
  /// not within reach or has no label
  /// @param threads  0: all cores; the candidates do not depend on it
  std::vector<PoseCandidate> candidates(const SourcePoints& source, const std::optional<SearchRegion>& region = {},
                                        int threads = 0) const;

  /// Memory of its index (bytes); 0 where that is a file.
  std::size_t memoryUsage() const;

 private:
  struct Parts;
  std::shared_ptr<const Parts> parts_;
};

}  // namespace saw_ndt
