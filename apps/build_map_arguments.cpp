#include "build_map_arguments.h"

#include <boost/algorithm/string/split.hpp>
#include <numeric>
#include <sstream>
#include <utility>

#include "common/atomic_output.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/drives/scan_selection.h"
#include "segmentation/segmentation_fields.h"

namespace saw_ndt {

using internal::DrivePlan;

BuildMapArguments::BuildMapArguments(AppOptions& app) : app_(app), resolution_m_(DriveMapOptions().resolution_m) {
  app.addPositionalList(
      "SEQUENCE", &sequences_,
      std::string(RecordingArgument::kKinds) + "; several, whose poses are in one map frame, make one map");
  app.addPositional("MAP", &map_file_, "map file to write");
  app.addOption("resolution", &resolution_m_, "METRES", "edge of the smallest voxels that methods can match");
  app.addOption("scans", &scans_, "SLICE",
                "scans to use of each recording, first:last:step as in Python: `0:70:2`, or all with `:`");
  app.addOption("shard", &shard_, "I/N",
                "of these scans every N-th one beginning with the I-th (1 to N), so that N jobs share the work: "
                "saw_ndt_map_merge makes of their maps the one of all scans. Sensor, mounting and motion compensation "
                "are learned as for all of them");
  app.addFlag("classical", &classical_, "do not segment: raw points without labels");
  app.addFlag("strict", &strict_, "a scan that cannot be read is an error, and nothing is written");
  app.addOption("poses", &poses_files_, "FILE,...",
                "reference poses instead of the recordings' own, a file for each: TUM or CSV, of the LiDAR, or KITTI, "
                "a line a scan, of the left camera where there is its calibration (default: those of the bag, KITTI's "
                "oxts, or poses.txt in or above the folder, or ../../poses/<name>.txt)");
  motion_.addTo(app);
  recording_argument_.addTo(app, false);
  segmentation_.addTo(app);
}

std::vector<std::string> BuildMapArguments::posesFiles() const {
  std::vector<std::string> files(sequences_.size());
  if (poses_files_.empty()) return files;
  // The name of a single file may have commas.
  if (files.size() == 1) return {poses_files_};
  boost::split(files, poses_files_, [](char c) { return c == ','; });
  if (files.size() != sequences_.size()) {
    throw UsageError("option -poses: '" + poses_files_ + "' has " + std::to_string(files.size()) +
                     " files, where there are " + std::to_string(sequences_.size()) + " recordings");
  }
  return files;
}

const Recording& BuildMapArguments::open(int drive) {
  if (open_drive_ != drive) {
    const auto i = static_cast<std::size_t>(drive);
    recording_ = recording_argument_.open(sequences_.at(i), posesFiles().at(i));
    open_drive_ = drive;
  }
  return *recording_;
}

std::vector<DrivePlan> BuildMapArguments::plan() {
  checkedUsage([&] { return WeightedMapBuilder(resolution_m_); });
  segmentation_.stated();
  motion_text_.clear();
  std::vector<DrivePlan> plans;
  for (std::size_t i = 0; i < sequences_.size(); ++i) {
    const Recording& recording = open(static_cast<int>(i));
    const std::vector<int> selected = checkedUsage([&] { return parseScanSelection(scans_, recording.scanCount()); });
    if (sequences_.size() == 1) checkedUsage([&] { return parseScanShard(shard_, selected); });
    recording.referencePose(selected.front());
    if (!recording.hasPoses()) {
      throw Error(sequences_[i], "", "has no reference poses, which a map is built by; -poses FILE gives them");
    }
    // Found out before the long work: whether the map can be written. This leaves nothing behind.
    if (i == 0) const internal::AtomicOutput probe(map_file_);
    plans.push_back(planOf(recording, selected, plans.empty() ? std::nullopt : plans.front().segmentation));
    requireSegmentedAlike(plans.back(), plans.front(), recording);
  }
  keepShard(plans);
  return plans;
}

DrivePlan BuildMapArguments::planOf(const Recording& recording, const std::vector<int>& selected,
                                    const std::optional<SegmentationOptions>& of_map) {
  DrivePlan plan;
  plan.scans = selected;
  if (!classical_) {
    const std::vector<ScanPoints> first = firstScans(*recording.scans(selected));
    plan.segmentation = of_map ? segmentation_.learnedFrom(first, {Eigen::Matrix3d::Identity(), of_map})
                               : segmentation_.learnedFrom(first);
  }
  const MotionTrial motion = motion_.decide(app_, recording, selected, [&] {
    if (!recording.hasStamps()) return MotionTrial{MotionCompensation::OFF, "scans have no stamps"};
    DriveMapOptions options;
    options.resolution_m = resolution_m_;
    options.segmentation = plan.segmentation;
    options.threads = app_.threads();
    options.scan_period_s = recording.scanPeriod();
    options.trajectory = recording.trajectory();
    return tryMotionCompensation(options, *recording.scans(selected));
  });
  plan.motion_compensation = motion.compensation;
  if (sequences_.size() > 1) motion_text_ += recording.path().string() + ": ";
  motion_text_ += std::string("motion compensation ") + toString(motion.compensation) + ": " + motion.reason + '\n';
  return plan;
}

void BuildMapArguments::requireSegmentedAlike(const DrivePlan& plan, const DrivePlan& first,
                                              const Recording& recording) const {
  if (!plan.segmentation) return;
  const auto difference =
      firstDifference(internal::mountedAs(*first.segmentation, *plan.segmentation), *plan.segmentation);
  if (!difference) return;
  throw Error(recording.path().string(), "",
              "does not go into one map with " + sequences_.front() + ": " + difference->field + " is " +
                  difference->second + ", there " + difference->first +
                  "; where it is the same sensor, -sensor states it");
}

// The scans of all drives are numbered through.
void BuildMapArguments::keepShard(std::vector<DrivePlan>& plans) const {
  std::size_t total = 0;
  for (const DrivePlan& plan : plans) total += plan.scans.size();
  std::vector<int> all(total);
  std::iota(all.begin(), all.end(), 0);
  const std::vector<int> kept = checkedUsage([&] { return parseScanShard(shard_, all); });
  auto next = kept.begin();
  int first = 0;
  for (DrivePlan& plan : plans) {
    const int end = first + static_cast<int>(plan.scans.size());
    std::vector<int> scans;
    for (; next != kept.end() && *next < end; ++next)
      scans.push_back(plan.scans[static_cast<std::size_t>(*next - first)]);
    plan.scans = std::move(scans);
    first = end;
  }
}

DriveMapOptions BuildMapArguments::options(std::vector<std::string>& left_out, std::function<void()> scan_done) const {
  DriveMapOptions options;
  options.resolution_m = resolution_m_;
  options.threads = app_.threads();
  if (!strict_) {
    options.scan_left_out = [&left_out, scan_done = std::move(scan_done)](const std::string& failure) {
      left_out.push_back(failure);
      scan_done();
    };
  }
  return options;
}

std::string mapText(const std::string& map_file, std::size_t voxel_count, const MapOrigin& origin,
                    std::size_t left_out_count) {
  std::ostringstream text;
  text << map_file << ": " << voxel_count << " voxels of " << origin.resolution_m << " m from " << origin.point_count
       << " points of " << origin.scan_count << " scans";
  if (left_out_count != 0) text << ", " << left_out_count << " left out";
  return text.str();
}

}  // namespace saw_ndt
