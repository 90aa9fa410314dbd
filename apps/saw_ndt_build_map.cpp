#include <iostream>
#include <utility>

#include "app_options.h"
#include "build_map_arguments.h"
#include "progress_bar.h"
#include "remove_moved_argument.h"
#include "saw_ndt/drives/moved_removal.h"

namespace {

constexpr char kDescription[] =
    "Builds an NDT map from the scans of drives and their reference poses. Scans are segmented and the map keeps the "
    "sums of ground, non-ground and noise points of every voxel apart, so that one map serves every method of "
    "saw_ndt_localize; with -classical they are taken raw and the map serves the method classical alone. A scan that "
    "cannot be read is left out. The same scans give the same bytes, in any order and with any number of threads. Of "
    "several drives the first one tells how scans are segmented: the others must have the same sensor, in any "
    "mounting.";

std::size_t scanCountOf(const std::vector<saw_ndt::internal::DrivePlan>& plans) {
  std::size_t count = 0;
  for (const saw_ndt::internal::DrivePlan& plan : plans) count += plan.scans.size();
  return count;
}

// The map of the scans without what moved, which are read once more for that.
saw_ndt::WeightedVoxelMap withoutMoved(saw_ndt::WeightedVoxelMap map, const saw_ndt::RemoveMovedArgument& remove_moved,
                                       saw_ndt::BuildMapArguments& arguments,
                                       const std::vector<saw_ndt::internal::DrivePlan>& plans) {
  return remove_moved.remove(std::move(map), arguments.mapFile(), [&](saw_ndt::MovedVoxels& moved) {
    saw_ndt::ProgressBar progress(scanCountOf(plans));
    const auto step = [&] { progress.step(); };
    std::vector<std::string> told_already;
    const saw_ndt::DriveMapOptions common = arguments.options(told_already, step);
    for (std::size_t i = 0; i < plans.size(); ++i) {
      const saw_ndt::Recording& recording = arguments.open(static_cast<int>(i));
      saw_ndt::addScans(*recording.scans(plans[i].scans), saw_ndt::internal::optionsFor(plans[i], recording, common),
                        moved, step);
    }
  });
}

}  // namespace

int main(int argc, char** argv) {
  saw_ndt::AppOptions app("saw_ndt_build_map", kDescription);
  saw_ndt::BuildMapArguments arguments(app);
  bool removes_moved = false;
  saw_ndt::RemoveMovedArgument remove_moved;
  app.addFlag("remove-moved", &removes_moved,
              "remove what moved, vehicles and persons: voxels that few of the scans hit which saw onto or through "
              "them. Scans are read twice");
  remove_moved.addTo(app);
  return saw_ndt::runApp(argc, argv, app, [&] {
    if (app.isGiven("max-hit-share") && !removes_moved) {
      throw saw_ndt::UsageError("-max-hit-share goes with -remove-moved");
    }
    if (removes_moved && app.isGiven("shard")) {
      throw saw_ndt::UsageError(
          "-remove-moved needs all scans, not those of a -shard: saw_ndt_map_remove_moved takes the merged map");
    }
    remove_moved.check();
    const std::vector<saw_ndt::internal::DrivePlan> plans = arguments.plan();
    std::vector<std::string> left_out;
    std::optional<saw_ndt::ProgressBar> progress(scanCountOf(plans));
    const auto step = [&] { progress->step(); };
    saw_ndt::WeightedMapBuilder builder = saw_ndt::internal::buildMapOfDrives(
        plans, [&](int drive) -> const saw_ndt::Recording& { return arguments.open(drive); },
        arguments.options(left_out, step), std::filesystem::path(arguments.mapFile()).parent_path() / ".", step);
    progress.reset();
    for (const std::string& failure : left_out) std::cerr << app.name() << ": " << failure << ": left out\n";
    saw_ndt::MapOrigin origin = builder.origin();
    std::size_t voxel_count = 0;
    if (removes_moved) {
      const saw_ndt::WeightedVoxelMap map = withoutMoved(std::move(builder).build(), remove_moved, arguments, plans);
      map.save(arguments.mapFile());
      origin = map.origin();
      voxel_count = map.voxelCount({}, app.threads());
    } else {
      voxel_count = builder.save(arguments.mapFile(), app.threads()).voxel_count;
    }
    std::cout << saw_ndt::mapText(arguments.mapFile(), voxel_count, origin, left_out.size()) << '\n'
              << arguments.motionText();
  });
}
