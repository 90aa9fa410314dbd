#include <iostream>
#include <utility>

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
#include "segmentation_options.h"

namespace {

constexpr char kDescription[] =
    "Builds an NDT map from the scans of a drive and their reference poses. Scans are segmented and the map keeps the "
    "sums of ground, non-ground and noise points of every voxel apart, so that one map serves every method of "
    "saw_ndt_localize; with -classical they are taken raw and the map serves the method classical alone. A scan that "
    "cannot be read is left out. The same scans give the same bytes, in any order and with any number of threads.";

// Sets how motion is taken out of the scans, and says why. Without stamps none is known.
std::string setMotionCompensation(const saw_ndt::AppOptions& app, const saw_ndt::MotionArgument& argument,
                                  const saw_ndt::Recording& recording, const std::vector<int>& selected,
                                  saw_ndt::DriveMapOptions& options) {
  const saw_ndt::MotionTrial motion = argument.decide(app, recording, selected, [&] {
    if (!recording.hasStamps()) {
      return saw_ndt::MotionTrial{saw_ndt::MotionCompensation::OFF, "scans have no stamps"};
    }
    options.scan_period_s = recording.scanPeriod();
    options.trajectory = recording.trajectory();
    return saw_ndt::tryMotionCompensation(options, *recording.scans(selected));
  });
  options.motion_compensation = motion.compensation;
  if (motion.compensation != saw_ndt::MotionCompensation::OFF) {
    options.scan_period_s = recording.scanPeriod();
    options.trajectory = recording.trajectory();
  }
  return std::string("motion compensation ") + saw_ndt::toString(motion.compensation) + ": " + motion.reason;
}

}  // namespace

int main(int argc, char** argv) {
  std::string sequence, map_file, scans = ":", shard = "1/1";
  bool classical = false, strict = false, removes_moved = false;
  saw_ndt::RemoveMovedArgument remove_moved;
  saw_ndt::DriveMapOptions options;
  saw_ndt::SegmentationArguments segmentation;
  saw_ndt::RecordingArgument recording_argument;
  saw_ndt::MotionArgument motion;
  saw_ndt::AppOptions app("saw_ndt_build_map", kDescription);
  app.addPositional("SEQUENCE", &sequence, saw_ndt::RecordingArgument::kKinds);
  app.addPositional("MAP", &map_file, "map file to write");
  app.addOption("resolution", &options.resolution_m, "METRES", "edge of the smallest voxels that methods can match");
  app.addOption("scans", &scans, "SLICE", "scans to use, first:last:step as in Python: `0:70:2`, or all with `:`");
  app.addOption("shard", &shard, "I/N",
                "of these scans every N-th one beginning with the I-th (1 to N), so that N jobs share the work: "
                "saw_ndt_map_merge makes of their maps the one of all scans. Sensor, mounting and motion compensation "
                "are learned as for all of them");
  app.addFlag("classical", &classical, "do not segment: raw points without labels");
  app.addFlag("strict", &strict, "a scan that cannot be read is an error, and nothing is written");
  app.addFlag("remove-moved", &removes_moved,
              "remove what moved, vehicles and persons: voxels that few of the scans hit which saw onto or through "
              "them. Scans are read twice");
  remove_moved.addTo(app);
  motion.addTo(app);
  recording_argument.addTo(app);
  segmentation.addTo(app);

  return saw_ndt::runApp(argc, argv, app, [&] {
    const std::unique_ptr<saw_ndt::Recording> recording = recording_argument.open(sequence);
    const std::vector<int> selected =
        saw_ndt::checkedUsage([&] { return saw_ndt::parseScanSelection(scans, recording->scanCount()); });
    const std::vector<int> mapped = saw_ndt::checkedUsage([&] { return saw_ndt::parseScanShard(shard, selected); });
    if (app.isGiven("max-hit-share") && !removes_moved) {
      throw saw_ndt::UsageError("-max-hit-share goes with -remove-moved");
    }
    if (removes_moved && mapped.size() != selected.size()) {
      throw saw_ndt::UsageError(
          "-remove-moved needs all scans, not those of a -shard: saw_ndt_map_remove_moved takes the merged map");
    }
    remove_moved.check();
    options.threads = app.threads();
    options.segmentation = segmentation.stated();
    saw_ndt::checkedUsage([&] { return saw_ndt::WeightedMapBuilder(options.resolution_m); });

    recording->referencePose(selected.front());
    if (!recording->hasPoses()) {
      throw saw_ndt::Error(sequence, "", "has no reference poses, which a map is built by; -poses FILE gives them");
    }
    // Found out before the long work: whether the map can be written. This leaves nothing behind.
    { const saw_ndt::internal::AtomicOutput probe(map_file); }
    if (classical) {
      options.segmentation.reset();
    } else {
      options.segmentation = segmentation.learnedFrom(saw_ndt::firstScans(*recording->scans(selected)));
    }

    const std::string motion_text = setMotionCompensation(app, motion, *recording, selected, options);
    saw_ndt::ProgressBar progress(mapped.size());
    std::vector<std::string> left_out;
    if (!strict) {
      options.scan_left_out = [&](const std::string& failure) {
        left_out.push_back(failure);
        progress.step();
      };
    }
    saw_ndt::WeightedVoxelMap map =
        saw_ndt::buildDriveMap(*recording->scans(mapped), options, [&] { progress.step(); }).build();
    for (const std::string& failure : left_out) std::cerr << app.name() << ": " << failure << ": left out\n";
    if (removes_moved) {
      map = remove_moved.remove(std::move(map), map_file, [&](saw_ndt::MovedVoxels& moved) {
        saw_ndt::ProgressBar second(mapped.size());
        if (!strict) options.scan_left_out = [&](const std::string&) { second.step(); };  // told already
        saw_ndt::addScans(*recording->scans(mapped), options, moved, [&] { second.step(); });
      });
    }
    map.save(map_file);
    std::cout << map_file << ": " << map.voxelCount({}, options.threads) << " voxels of " << map.resolution()
              << " m from " << map.origin().point_count << " points of " << map.origin().scan_count << " scans";
    if (!left_out.empty()) std::cout << ", " << left_out.size() << " left out";
    std::cout << '\n' << motion_text << '\n';
  });
}
