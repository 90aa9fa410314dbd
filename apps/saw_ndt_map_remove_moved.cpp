#include <iostream>

#include "app_options.h"
#include "common/atomic_output.h"
#include "motion_argument.h"
#include "progress_bar.h"
#include "recording_argument.h"
#include "remove_moved_argument.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/drives/drive_map.h"
#include "saw_ndt/drives/moved_removal.h"
#include "saw_ndt/drives/scan_selection.h"

namespace {

constexpr char kDescription[] =
    "Removes from a map what moved while it was recorded: voxels that few of the scans hit which saw onto or through "
    "them. It reads the scans of the map a second time, with the options that it was built by; -remove-moved of "
    "saw_ndt_build_map does the same at once. For maps that were merged, as of -shard jobs or of several drives: give "
    "all their drives. Points labelled ground stay. The same map and scans give the same bytes, in any order and with "
    "any number of threads.";

// The options by which the scans of a recording were added to the map.
saw_ndt::DriveMapOptions optionsFor(const saw_ndt::AppOptions& app, const saw_ndt::MotionArgument& motion,
                                    const saw_ndt::Recording& recording, const std::vector<int>& selected,
                                    const saw_ndt::MapOrigin& origin) {
  saw_ndt::DriveMapOptions options;
  options.threads = app.threads();
  options.resolution_m = origin.resolution_m;
  options.segmentation = origin.segmentation;
  if (recording.hasStamps()) {
    options.scan_period_s = recording.scanPeriod();
    options.trajectory = recording.trajectory();
  }
  options.motion_compensation =
      motion
          .decide(app, recording, selected,
                  [&] {
                    if (!recording.hasStamps()) return saw_ndt::MotionTrial();
                    return saw_ndt::tryMotionCompensation(options, *recording.scans(selected));
                  })
          .compensation;
  return options;
}

}  // namespace

int main(int argc, char** argv) {
  std::string map_file, remaining_file, scans = ":";
  std::vector<std::string> sequences;
  bool strict = false;
  saw_ndt::RemoveMovedArgument remove_moved;
  saw_ndt::RecordingArgument recording_argument;
  saw_ndt::MotionArgument motion;
  saw_ndt::AppOptions app("saw_ndt_map_remove_moved", kDescription);
  app.addPositional("MAP", &map_file, "map file");
  app.addPositional("OUT", &remaining_file, "map file to write; may be MAP");
  app.addPositionalList("SEQUENCE", &sequences,
                        std::string(saw_ndt::RecordingArgument::kKinds) + "; each drive of the map once");
  remove_moved.addTo(app);
  app.addOption("scans", &scans, "SLICE", "scans of each drive that the map was built of, as of saw_ndt_build_map");
  app.addFlag("strict", &strict, "a scan that cannot be read is an error, and nothing is written");
  motion.addTo(app);
  recording_argument.addTo(app);

  return saw_ndt::runApp(argc, argv, app, [&] {
    remove_moved.check();
    if (sequences.size() > 1 && app.isGiven("poses")) throw saw_ndt::UsageError("-poses goes with one SEQUENCE");
    // Found out before the long work: whether the map can be written. This leaves nothing behind.
    { const saw_ndt::internal::AtomicOutput probe(remaining_file); }
    saw_ndt::WeightedVoxelMap map = saw_ndt::WeightedVoxelMap::load(map_file);
    std::size_t left_out = 0;
    const saw_ndt::WeightedVoxelMap remaining =
        remove_moved.remove(std::move(map), remaining_file, [&](saw_ndt::MovedVoxels& moved) {
          for (const std::string& sequence : sequences) {
            const std::unique_ptr<saw_ndt::Recording> recording = recording_argument.open(sequence);
            const std::vector<int> selected =
                saw_ndt::checkedUsage([&] { return saw_ndt::parseScanSelection(scans, recording->scanCount()); });
            recording->referencePose(selected.front());
            if (!recording->hasPoses()) {
              throw saw_ndt::Error(sequence, "", "has no reference poses; -poses FILE gives them");
            }
            saw_ndt::DriveMapOptions options = optionsFor(app, motion, *recording, selected, moved.map().origin());
            saw_ndt::ProgressBar progress(selected.size());
            if (!strict) {
              options.scan_left_out = [&](const std::string& failure) {
                std::cerr << app.name() << ": " << failure << ": left out\n";
                ++left_out;
                progress.step();
              };
            }
            saw_ndt::addScans(*recording->scans(selected), options, moved, [&] { progress.step(); });
          }
        });
    remaining.save(remaining_file);
    std::cout << remaining_file << ": " << remaining.voxelCount({}, app.threads()) << " voxels of "
              << remaining.resolution() << " m from " << remaining.origin().point_count << " points";
    if (left_out != 0) std::cout << ", " << left_out << " scans left out";
    std::cout << '\n';
  });
}
