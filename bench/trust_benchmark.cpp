// Tells how far a localizer can be trusted: whether it accepts wrong poses, and whether it says when it is lost, in
// drives with faults and in scenes that say little of where one is.

#include <algorithm>
#include <iostream>
#include <map>
#include <memory>
#include <mutex>
#include <optional>

#include "app_options.h"
#include "campaign_drives.h"
#include "common/executor.h"
#include "fault_campaign.h"
#include "progress_bar.h"
#include "saw_ndt/common/error.h"
#include "temporary_folder.h"
#include "trust_measures.h"

namespace {

using saw_ndt::CampaignDrive;
using saw_ndt::Fault;
using saw_ndt::TrustCounts;

constexpr char kDescription[] =
    "Localizes simulated drives with faults in the map of another drive through the same scene, and prints how often a "
    "wrong pose was accepted and how soon the localizer said that it is lost. A pose is wrong that is off by more than "
    "0.5 m or 2 degrees beyond three standard deviations of what the scan leaves free. A run is "
    "astray where the published pose is wrong from some scan on until the localizer says that it is lost or the run "
    "ends; 'scans until lost' counts from the first of these scans. 'NEES / 6' and 'inside 95 %' tell of accepted "
    "scans whether the error is what the covariance says: 1 and 95 % are right. Faults of the start meet a vehicle "
    "anywhere on the way; others come on a drive from its beginning, after 30 to 230 scans, and the scans before them "
    "are not counted.";

// Of a run: what comes before a fault, the fault and a scan after it.
constexpr std::size_t kLeastScans = saw_ndt::kLeastRunUp + 2;

// Of an initial pose that may look anywhere.
constexpr double kAnyHeadingSigma_deg = 60.0;

struct Arguments {
  std::vector<std::string> scenes{"residential", "highway", "rural", "tunnel", "bridge", "plain", "equal_houses"};
  std::vector<std::string> kinds = saw_ndt::faultKinds();
  std::string method = "weighted", work;
  int seeds = 3, scans = 200, threads = 0;
  bool strengths = false, trace = false;
};

/// The map that runs are localized in, and where they start in it unless that follows from the drive.
struct Place {
  saw_ndt::NdtTarget target;
  std::optional<Eigen::Isometry3d> start;
};

/// A run of a fault in a scene.
struct Cell {
  const Fault* fault;  ///< of allFaults()
  int seed;            ///< of what is random

  std::size_t faultNumber() const { return static_cast<std::size_t>(fault - saw_ndt::allFaults().data()); }
};

saw_ndt::CampaignRun makeRun(const Cell& cell, const saw_ndt::LoadedDrive& drive, int scans) {
  const Fault& fault = *cell.fault;
  const std::size_t in_drive = drive.scans.size(), count = std::min(static_cast<std::size_t>(scans), in_drive);
  // The same place for all faults of a seed, so that they can be compared.
  saw_ndt::SceneRandom of_seed(saw_ndt::mixedSeed(cell.seed, 1));
  saw_ndt::CampaignRun run;
  if (fault.drive == CampaignDrive::BRAKING) {
    run = saw_ndt::CampaignRun::recorded(drive, 0, in_drive);
  } else if (fault.from_start) {
    run = saw_ndt::CampaignRun::recorded(drive, of_seed.index(in_drive - count + 1), count);
  } else {
    const std::size_t room = std::min(in_drive - count, saw_ndt::kGreatestRunUp - saw_ndt::kLeastRunUp);
    const std::size_t more_run_up = of_seed.index(room + 1);
    run = saw_ndt::CampaignRun::recorded(drive, 0, more_run_up + count);
    run.fault_begin = more_run_up + saw_ndt::kLeastRunUp;
  }
  saw_ndt::SceneRandom of_fault(saw_ndt::mixedSeed(cell.seed, 2, cell.faultNumber()));
  if (fault.apply) fault.apply(run, drive, of_fault);
  return run;
}

TrustCounts play(const saw_ndt::CampaignRun& run, const saw_ndt::LoadedDrive& drive, const Place& place,
                 const saw_ndt::LocalizationMethod& method, const std::string& name, double initial_sigma_deg,
                 bool trace) {
  static std::mutex output;
  saw_ndt::LocalizerOptions options;
  options.method = method;
  options.prediction.initial_sigma_deg = initial_sigma_deg;
  options.alignment.threads = 1;
  saw_ndt::Localizer localizer(place.target, options);
  if (run.T_map_base_initial) {
    localizer.setInitialPose(place.start.value_or(*run.T_map_base_initial));
  } else {
    localizer.setUnknownPose();
  }
  saw_ndt::RunJudge judge(run);
  std::vector<saw_ndt::LidarPoint> altered;
  try {
    for (const saw_ndt::PlayedScan& scan : run.scans) {
      const std::vector<saw_ndt::LidarPoint>* points = &drive.scans[scan.recorded];
      if (scan.alter) {
        altered = *points;
        scan.alter(altered);
        points = &altered;
      }
      judge.see(localizer.localize(saw_ndt::viewOf(*points), scan.stamp_s, scan.priors));
      if (!trace) continue;
      const std::lock_guard<std::mutex> lock(output);
      std::cerr << name << ": " << judge.lastInWords() << '\n';
    }
  } catch (const std::exception& error) {
    judge.fail();
    const std::lock_guard<std::mutex> lock(output);
    std::cerr << name << ": " << error.what() << std::endl;
  }
  const TrustCounts counts = judge.finish();
  if (counts.wrong_accepted > 0) {
    const std::lock_guard<std::mutex> lock(output);
    std::cerr << name << ": " << counts.wrong_accepted << " wrong poses accepted, worst " << counts.worst_m << " m, "
              << counts.worst_deg << " deg; fault from scan " << run.fault_begin << ", first at "
              << judge.firstWrongAccepted() << std::endl;
  }
  return counts;
}

class Campaign {
 public:
  Campaign(const Arguments& arguments, const std::filesystem::path& folder)
      : arguments_(arguments),
        method_(saw_ndt::LocalizationMethod::named(arguments.method)),
        drives_(folder, method_, arguments.threads) {}

  /// Prints the rows of a scene.
  void runScene(std::size_t scene_number) {
    const std::string& scene = arguments_.scenes[scene_number];
    std::map<std::string, TrustCounts> of_rows;
    std::vector<std::string> rows;  // in the order of the faults
    for (const Fault* fault : chosenFaults()) {
      const std::string row = rowOf(*fault);
      if (of_rows.emplace(row, TrustCounts()).second) rows.push_back(row);
    }
    for (const CampaignDrive which : {CampaignDrive::TEST, CampaignDrive::DENSE_TRAFFIC, CampaignDrive::BRAKING}) {
      runDrive(scene_number, which, of_rows);
    }
    for (const std::string& row : rows) {
      std::cout << saw_ndt::trustTableRow({scene, row}, of_rows[row]);
      if (of_all_scenes_.emplace(row, TrustCounts()).second) all_rows_.push_back(row);
      of_all_scenes_[row].add(of_rows[row]);
    }
    std::cout << std::flush;
  }

  void printTotals() {
    TrustCounts all;
    for (const std::string& row : all_rows_) {
      std::cout << saw_ndt::trustTableRow({"all", row}, of_all_scenes_[row]);
      all.add(of_all_scenes_[row]);
    }
    std::cout << saw_ndt::trustTableRow({"all", "all"}, all);
  }

 private:
  std::vector<const Fault*> chosenFaults() const {
    std::vector<const Fault*> chosen;
    for (const Fault& fault : saw_ndt::allFaults()) {
      const auto& kinds = arguments_.kinds;
      if (std::find(kinds.begin(), kinds.end(), fault.kind) != kinds.end()) chosen.push_back(&fault);
    }
    return chosen;
  }

  std::string rowOf(const Fault& fault) const {
    return arguments_.strengths && !fault.strength.empty() ? fault.kind + ", " + fault.strength : fault.kind;
  }

  Place placeOf(const Fault& fault, std::size_t scene_number) {
    const std::string& scene = arguments_.scenes[scene_number];
    switch (fault.map) {
      case saw_ndt::CampaignMap::OWN:
        return {drives_.target(scene, CampaignDrive::MAP), std::nullopt};
      case saw_ndt::CampaignMap::CHANGED:
        return {drives_.target(scene, CampaignDrive::SPARSE_MAP), std::nullopt};
      case saw_ndt::CampaignMap::OF_OTHER_SCENE:
        break;
    }
    const std::vector<std::string> usual = Arguments().scenes;
    std::string other = arguments_.scenes[(scene_number + 1) % arguments_.scenes.size()];
    if (other == scene) other = scene == usual[0] ? usual[1] : usual[0];
    return {drives_.target(other, CampaignDrive::MAP), drives_.courseStart(other)};
  }

  void runDrive(std::size_t scene_number, CampaignDrive which, std::map<std::string, TrustCounts>& of_rows) {
    const std::string& scene = arguments_.scenes[scene_number];
    std::vector<Cell> cells;
    std::map<saw_ndt::CampaignMap, Place> places;
    for (const Fault* fault : chosenFaults()) {
      if (fault->drive != which) continue;
      if (places.count(fault->map) == 0) places.emplace(fault->map, placeOf(*fault, scene_number));
      const bool random = which != CampaignDrive::BRAKING;
      for (int seed = 1; seed <= (random ? arguments_.seeds : 1); ++seed) cells.push_back({fault, seed});
    }
    if (cells.empty()) return;
    const saw_ndt::LoadedDrive drive = drives_.load(scene, which);
    if (drive.scans.size() < kLeastScans) throw saw_ndt::Error(scene, "", "has too short a course");
    std::cerr << scene << ": " << cells.size() << " runs" << std::endl;
    std::vector<TrustCounts> counts(cells.size());
    saw_ndt::ProgressBar progress(cells.size());
    saw_ndt::internal::forEachChunkOffline(arguments_.threads, cells.size(), [&](std::size_t i, int) {
      const Cell& cell = cells[i];
      const saw_ndt::CampaignRun run = makeRun(cell, drive, arguments_.scans);
      const std::string name =
          scene + ", " + cell.fault->kind + " " + cell.fault->strength + ", seed " + std::to_string(cell.seed);
      counts[i] =
          play(run, drive, places.at(cell.fault->map), method_, name,
               cell.fault->from_start ? kAnyHeadingSigma_deg : saw_ndt::MotionPredictionOptions().initial_sigma_deg,
               arguments_.trace);
      progress.step();
    });
    for (std::size_t i = 0; i < cells.size(); ++i) of_rows[rowOf(*cells[i].fault)].add(counts[i]);
  }

  const Arguments& arguments_;
  saw_ndt::LocalizationMethod method_;
  saw_ndt::CampaignDrives drives_;
  std::map<std::string, TrustCounts> of_all_scenes_;
  std::vector<std::string> all_rows_;
};

void check(const Arguments& arguments) {
  if (arguments.seeds < 1) throw saw_ndt::UsageError("option -seeds: must be 1 or more");
  if (arguments.scans < static_cast<int>(kLeastScans)) {
    throw saw_ndt::UsageError("option -scans: must be " + std::to_string(kLeastScans) + " or more");
  }
  const std::vector<std::string> known = saw_ndt::faultKinds();
  for (const std::string& kind : arguments.kinds) {
    if (std::find(known.begin(), known.end(), kind) != known.end()) continue;
    std::string message = "option -faults: '" + kind + "' is none of";
    for (const std::string& name : known) message += " " + name;
    throw saw_ndt::UsageError(message);
  }
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  saw_ndt::AppOptions app("trust_benchmark", kDescription);
  app.addOption("scenes", &arguments.scenes, "NAME,...", "scenes, names or files as of saw_ndt_simulate");
  app.addOption("faults", &arguments.kinds, "NAME,...", "kinds of faults");
  app.addOption("seeds", &arguments.seeds, "N", "runs of each strength of a fault in each scene");
  app.addOption("scans", &arguments.scans, "N",
                "scans of a run: from 30 before the fault on, where it comes on the way");
  app.addOption("work", &arguments.work, "DIR",
                "folder that keeps the simulated drives, 2 to 8 GB a scene, for the next time (default: none is kept)");
  app.addChoice("method", &arguments.method, saw_ndt::LocalizationMethod::names(), "method of the localizer");
  app.addFlag("strengths", &arguments.strengths, "a row for each strength of a fault");
  app.addFlag("trace", &arguments.trace, "say of every scan what becomes of it");
  return saw_ndt::runApp(argc, argv, app, [&] {
    check(arguments);
    arguments.threads = app.threads();
    std::unique_ptr<saw_ndt::TemporaryFolder> temporary;
    if (arguments.work.empty()) temporary = std::make_unique<saw_ndt::TemporaryFolder>();
    Campaign campaign(arguments, temporary ? temporary->path() : std::filesystem::path(arguments.work));
    std::cout << saw_ndt::trustTableHead({"scene", "fault"}) << std::flush;
    for (std::size_t scene = 0; scene < arguments.scenes.size(); ++scene) campaign.runScene(scene);
    campaign.printTotals();
  });
}
