#include "drives/drive_plan.h"

#include <sstream>

#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

DriveMapOptions optionsFor(const DrivePlan& plan, const Recording& recording, DriveMapOptions common) {
  common.segmentation = plan.segmentation;
  common.motion_compensation = plan.motion_compensation;
  if (plan.motion_compensation != MotionCompensation::OFF) {
    common.scan_period_s = recording.scanPeriod();
    common.trajectory = recording.trajectory();
  }
  return common;
}

DriveMapOptions notingFailures(const DriveMapOptions& options, std::string& last_failure) {
  DriveMapOptions noting = options;
  if (options.scan_left_out) {
    noting.scan_left_out = [&](const std::string& failure) {
      last_failure = failure;
      options.scan_left_out(failure);
    };
  }
  return noting;
}

void requireAnyPoint(const MapOrigin& origin, const std::string& last_failure) {
  if (origin.scan_count == 0 && !last_failure.empty()) {
    throw Error(last_failure + ", and no other scan is any better");
  }
  if (origin.scan_count > 0 && origin.point_count == 0) {
    std::ostringstream reason;
    reason << "the map would have no point: no scan of " << origin.scan_count << " has one that voxels of "
           << origin.resolution_m << " m can be numbered up to";
    throw Error(reason.str());
  }
}

WeightedMapBuilder buildMapOfDrives(const std::vector<DrivePlan>& plans, const DriveOpener& open,
                                    const DriveMapOptions& common, const std::filesystem::path& spill_folder,
                                    const std::function<void()>& scan_done) {
  WeightedMapBuilder map(common.resolution_m, plans.front().segmentation);
  if (!spill_folder.empty()) map.limitMemory(kMostEntriesInMemory, spill_folder);
  std::string last_failure;
  const DriveMapOptions noting = notingFailures(common, last_failure);
  for (std::size_t i = 0; i < plans.size(); ++i) {
    const Recording& recording = open(static_cast<int>(i));
    addScans(*recording.scans(plans[i].scans), optionsFor(plans[i], recording, noting), map, scan_done);
  }
  requireAnyPoint(map.origin(), last_failure);
  return map;
}

}  // namespace saw_ndt::internal
