#pragma once

#include <functional>
#include <string>

#include "app_options.h"
#include "saw_ndt/map/moved_voxels.h"

namespace saw_ndt {

/// How apps remove what moved from a map.
class RemoveMovedArgument {
 public:
  /// Declares -max-hit-share.
  void addTo(AppOptions& app);

  /// Throws UsageError for an option that does not hold.
  void check() const;

  /// The map without what moved. Says on stdout, after `name`, how much that was.
  /// @param add_scans  adds the scans of the map, read a second time
  /// @throws UsageError for an option that does not hold
  WeightedVoxelMap remove(WeightedVoxelMap map, const std::string& name,
                          const std::function<void(MovedVoxels&)>& add_scans) const;

 private:
  MovedVoxelOptions options_;
};

}  // namespace saw_ndt
