#include <iostream>

#include "app_options.h"
#include "build_map_arguments.h"
#include "progress_bar.h"

namespace {

constexpr char kDescription[] =
    "Builds an NDT map from the scans of drives and their reference poses. Scans are segmented and the map keeps the "
    "sums of ground, non-ground and noise points of every voxel apart, so that one map serves every method of "
    "saw_ndt_localize; with -classical they are taken raw and the map serves the method classical alone. A scan that "
    "cannot be read is left out. The same scans give the same bytes, in any order and with any number of threads. Of "
    "several drives the first one tells how scans are segmented: the others must have the same sensor, in any "
    "mounting.";

}  // namespace

int main(int argc, char** argv) {
  saw_ndt::AppOptions app("saw_ndt_build_map", kDescription);
  saw_ndt::BuildMapArguments arguments(app);
  return saw_ndt::runApp(argc, argv, app, [&] {
    const std::vector<saw_ndt::internal::DrivePlan> plans = arguments.plan();
    std::size_t scan_count = 0;
    for (const saw_ndt::internal::DrivePlan& plan : plans) scan_count += plan.scans.size();
    saw_ndt::ProgressBar progress(scan_count);
    std::vector<std::string> left_out;
    const auto step = [&] { progress.step(); };
    const saw_ndt::WeightedMapBuilder map = saw_ndt::internal::buildMapOfDrives(
        plans, [&](int drive) -> const saw_ndt::Recording& { return arguments.open(drive); },
        arguments.options(left_out, step), std::filesystem::path(arguments.mapFile()).parent_path() / ".", step);
    for (const std::string& failure : left_out) std::cerr << app.name() << ": " << failure << ": left out\n";
    const saw_ndt::WrittenMap written = map.save(arguments.mapFile(), app.threads());
    std::cout << saw_ndt::mapText(arguments.mapFile(), written.voxel_count, map.origin(), left_out.size()) << '\n'
              << arguments.motionText();
  });
}
