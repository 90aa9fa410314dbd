// Whether a localizer that drives for hours, and through faults, needs more and more memory or time.

#include <time.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <memory>
#include <thread>

#include "app_options.h"
#include "common/large_blocks.h"
#include "endless_drive.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/drives/recording.h"
#include "saw_ndt/localization/localizer.h"
#include "soak_record.h"

namespace {

constexpr char kDescription[] =
    "Drives SEQUENCE again and again through the streamed tiles of MAP, the localization map of another drive of the "
    "same place, with faults: scans that are missing, empty, not a number, zeros or repeated, a sensor that is blinded "
    "for some seconds, and kidnappings. Prints a line of a table each interval, and in the end how fast memory and "
    "times grow. Exit code 1 where resident memory, or what of it is held once free memory has been given back, grows "
    "by more than 1 MB an hour or the median CPU time of a scan by "
    "more than 10 % an hour, in either case by more than twice the standard deviation of that slope.";

constexpr double kMostMemory_mb_per_hour = 1.0;
constexpr double kMostTime_percent_per_hour = 10.0;
constexpr double kWrong_m = 1.0;
constexpr int kHelpAfterScans = 300;  // without a right pose

struct Arguments {
  std::string map_file, sequence, method = "weighted";
  double minutes = 60.0, warm_up_minutes = 5.0, interval_s = 60.0;
  double radius_m = 60.0, search_budget_ms = 100.0;
  int fault_scans = 50, seed = 1;
  double most_scans_hz = 0.0;
};

/// CPU time of all threads of this process (ms).
double processTime_ms() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

saw_ndt::Localizer makeLocalizer(const Arguments& arguments, int threads) {
  const saw_ndt::LocalizationMap map(arguments.map_file);
  saw_ndt::LocalizerOptions options;
  options.method = saw_ndt::LocalizationMethod::named(arguments.method);
  options.alignment.threads = threads;
  options.segmentation = map.origin().segmentation.value_or(options.segmentation);
  options.search_budget_ms = arguments.search_budget_ms;
  options.tiles.radius_m = arguments.radius_m;
  map.requireWeighting(options.method.voxels);
  return {saw_ndt::TiledTarget(map, options.tiles), options};
}

/// Localizes an endless drive and counts what becomes of its scans.
class Soak {
 public:
  Soak(const Arguments& arguments, const saw_ndt::Recording& recording, int threads)
      : drive_(recording, static_cast<std::size_t>(arguments.fault_scans), static_cast<std::uint64_t>(arguments.seed)),
        localizer_(makeLocalizer(arguments, threads)),
        least_period_s_(arguments.most_scans_hz > 0.0 ? 1.0 / arguments.most_scans_hz : 0.0) {}

  /// Drives for so long.
  saw_ndt::SoakInterval drive(double seconds) {
    using Clock = std::chrono::steady_clock;
    const auto elapsed = [begin = Clock::now()] { return std::chrono::duration<double>(Clock::now() - begin).count(); };
    saw_ndt::SoakInterval counts;
    do {
      const double begin_s = elapsed();
      localizeNext(counts);
      std::this_thread::sleep_for(std::chrono::duration<double>(begin_s + least_period_s_ - elapsed()));
    } while (elapsed() < seconds);
    counts.seconds = elapsed();
    hours_ += counts.seconds / 3600.0;
    counts.end_h = hours_;
    return record_.endInterval(counts);
  }

  const saw_ndt::EndlessDrive& faults() const { return drive_; }
  const saw_ndt::TileLoads& loads() const { return *localizer_.tileLoads(); }

 private:
  void localizeNext(saw_ndt::SoakInterval& counts) {
    drive_.next();
    if (scans_without_pose_ >= kHelpAfterScans) {
      ++counts.helped;
      scans_without_pose_ = 0;
      localizer_.setInitialPose(drive_.truth());
    } else if (localizer_.track().status == saw_ndt::TrackStatus::NOT_INITIALIZED) {
      localizer_.setInitialPose(drive_.truth());
    }
    const double begin_ms = processTime_ms();
    const saw_ndt::LocalizationResult result = localizer_.localize(viewOf(drive_.scan()), drive_.stamp());
    record_.add(result.times.total_ms, processTime_ms() - begin_ms);
    const bool right =
        result.accepted() && (result.T_map_base.translation() - drive_.truth().translation()).norm() <= kWrong_m;
    ++counts.scans;
    counts.accepted += result.accepted() ? 1 : 0;
    counts.rejected += result.accepted() ? 0 : 1;
    counts.wrong += result.accepted() && !right ? 1 : 0;
    counts.lost += result.track.isLost() ? 1 : 0;
    scans_without_pose_ = right ? 0 : scans_without_pose_ + 1;
  }

  saw_ndt::EndlessDrive drive_;
  saw_ndt::Localizer localizer_;
  saw_ndt::SoakRecord record_;
  double least_period_s_;  // from scan to scan
  int scans_without_pose_ = 0;
  double hours_ = 0.0;
};

void printInterval(const saw_ndt::SoakInterval& interval) {
  std::cout << std::fixed << std::setprecision(1) << "| " << 60.0 * interval.end_h << " | " << std::setprecision(2)
            << interval.resident_mb << " | " << interval.held_mb << " | " << std::setprecision(1)
            << static_cast<double>(interval.scans) / interval.seconds << " | " << std::setprecision(2)
            << interval.median_ms << " | " << interval.p99_ms << " | " << interval.median_cpu_ms << " | "
            << interval.scans << " | " << interval.accepted << " | " << interval.rejected << " | " << interval.lost
            << " | " << interval.wrong << " | " << interval.helped << " | " << interval.threads << " | "
            << interval.descriptors << " |" << std::endl;
}

void printSlope(const char* what, const saw_ndt::Slope& slope, const char* unit, double most) {
  std::cout << what << ": " << std::showpos << slope.per_hour << std::noshowpos << " +- " << slope.sigma << ' ' << unit
            << ", at most " << most << (slope.exceeds(most) ? ": EXCEEDED" : ": held") << '\n';
}

/// @throws Error where memory or times grow
void judge(const Arguments& arguments, const std::vector<saw_ndt::SoakInterval>& intervals) {
  std::vector<double> hours, resident_mb, held_mb, median_ms, median_cpu_ms;
  for (const saw_ndt::SoakInterval& interval : intervals) {
    if (60.0 * interval.end_h - interval.seconds / 60.0 < arguments.warm_up_minutes - 1e-6) continue;
    hours.push_back(interval.end_h);
    resident_mb.push_back(interval.resident_mb);
    held_mb.push_back(interval.held_mb);
    median_ms.push_back(interval.median_ms);
    median_cpu_ms.push_back(interval.median_cpu_ms);
  }
  if (hours.size() < 3)
    throw saw_ndt::Error("fewer than three intervals after the warm-up: nothing can be said of growth");
  const auto inPercent = [](saw_ndt::Slope slope) {
    slope.per_hour *= 100.0 / slope.mean;
    slope.sigma *= 100.0 / slope.mean;
    return slope;
  };
  const saw_ndt::Slope memory = saw_ndt::slopeOf(hours, resident_mb), held = saw_ndt::slopeOf(hours, held_mb);
  const saw_ndt::Slope time = inPercent(saw_ndt::slopeOf(hours, median_cpu_ms));
  const saw_ndt::Slope by_clock = inPercent(saw_ndt::slopeOf(hours, median_ms));
  printSlope("resident memory", memory, "MB an hour", kMostMemory_mb_per_hour);
  printSlope("held memory", held, "MB an hour", kMostMemory_mb_per_hour);
  printSlope("median CPU time", time, "% an hour", kMostTime_percent_per_hour);
  std::cout << "median time by the clock, which is not judged: " << std::showpos << by_clock.per_hour << std::noshowpos
            << " +- " << by_clock.sigma << " % an hour\n";
  if (memory.exceeds(kMostMemory_mb_per_hour) || held.exceeds(kMostMemory_mb_per_hour))
    throw saw_ndt::Error("memory grows");
  if (time.exceeds(kMostTime_percent_per_hour)) throw saw_ndt::Error("the time of a scan grows");
}

void soak(const Arguments& arguments, int threads) {
  const std::unique_ptr<saw_ndt::Recording> recording = saw_ndt::openRecording(arguments.sequence);
  Soak soak(arguments, *recording, threads);
  std::cout
      << "| minute | resident MB | held MB | scans a second | median ms | p99 ms | median CPU ms | scans | accepted | "
         "rejected | lost | wrong | helped | threads | files open |\n|"
      << "---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  std::vector<saw_ndt::SoakInterval> intervals;
  intervals.reserve(static_cast<std::size_t>(60.0 * arguments.minutes / arguments.interval_s) + 2);
  do {
    intervals.push_back(soak.drive(arguments.interval_s));
    printInterval(intervals.back());
  } while (60.0 * intervals.back().end_h < arguments.minutes - 1e-6);
  std::cout << "\nfaults:";
  for (std::size_t i = 1; i < saw_ndt::kDriveFaults; ++i) {
    std::cout << (i > 1 ? ", " : " ") << soak.faults().faults()[i] << ' '
              << toString(static_cast<saw_ndt::DriveFault>(i));
  }
  std::cout << "\ntiles: " << soak.loads().loads << " sets loaded, " << soak.loads().wide_loads << " wide ones, "
            << soak.loads().waits << " waited for\n";
  judge(arguments, intervals);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  saw_ndt::AppOptions app("soak", kDescription);
  app.addPositional("MAP", &arguments.map_file, "localization map of a drive");
  app.addPositional("SEQUENCE", &arguments.sequence, "another drive of the place with its reference poses");
  app.addOption("minutes", &arguments.minutes, "N", "how long to drive");
  app.addOption("warm-up-minutes", &arguments.warm_up_minutes, "N", "that count for no slope");
  app.addOption("interval-s", &arguments.interval_s, "SECONDS", "that a line of the table stands for");
  app.addOption("fault-scans", &arguments.fault_scans, "N", "from one fault to the next, on average; 0: none");
  app.addOption("rate", &arguments.most_scans_hz, "HERTZ", "scans a second at most; 0: as fast as it goes");
  app.addOption("seed", &arguments.seed, "N", "of the faults");
  app.addOption("radius", &arguments.radius_m, "METRES", "around the vehicle, in which tiles are in memory");
  app.addOption("search-budget-ms", &arguments.search_budget_ms, "MILLISECONDS",
                "that a search of the whole map may hold up a scan");
  app.addChoice("method", &arguments.method, saw_ndt::LocalizationMethod::names(), "that MAP was packed for");
  return saw_ndt::runApp(argc, argv, app, [&] {
    saw_ndt::internal::returnLargeBlocks();  // as saw_ndt_localize does
    if (!(arguments.minutes > 0.0)) throw saw_ndt::UsageError("option -minutes: must be more than 0");
    if (!(arguments.interval_s > 0.0)) throw saw_ndt::UsageError("option -interval-s: must be more than 0");
    if (arguments.fault_scans < 0) throw saw_ndt::UsageError("option -fault-scans: must be 0 or more");
    soak(arguments, app.threads());
  });
}
