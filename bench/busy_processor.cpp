// How long a localizer takes for a scan while other programs use the processor too.

#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <memory>
#include <thread>
#include <vector>

#include "app_options.h"
#include "benchmark_program.h"
#include "benchmark_scans.h"
#include "evaluation/statistics.h"
#include "progress_bar.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/localization/localizer.h"

namespace {

constexpr int kScansBefore = 10;  // not measured: memory is allocated, threads are made

/// Programs that do nothing but use the processor, while this lives.
class EndlessLoops {
 public:
  explicit EndlessLoops(int count) {
    for (int i = 0; i < count; ++i) {
      const pid_t program = fork();
      if (program == 0) loopForever();
      if (program < 0) {
        end();
        throw saw_ndt::Error("fork", "", "could not start another program");
      }
      programs_.push_back(program);
    }
  }
  ~EndlessLoops() { end(); }
  EndlessLoops(const EndlessLoops&) = delete;
  EndlessLoops& operator=(const EndlessLoops&) = delete;

 private:
  [[noreturn]] static void loopForever() {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    volatile unsigned turns = 0;
    for (;;) turns = turns + 1;
  }

  void end() {
    for (const pid_t program : programs_) {
      kill(program, SIGKILL);
      waitpid(program, nullptr, 0);
    }
  }

  std::vector<pid_t> programs_;
};

/// The scans of the benchmarks' drive, which is driven again and again.
class Drive {
 public:
  Drive() : poses_(saw_ndt::benchmarkPoses()), stamps_s_(saw_ndt::benchmarkSequence().stamps()) {
    for (int scan = 0; scan <= saw_ndt::benchmarkMapScans().back(); ++scan) {
      scans_.push_back(saw_ndt::benchmarkSequence().readScan(scan));
    }
  }

  /// Localizes scan number `i` of the endless drive.
  saw_ndt::LocalizationResult localize(saw_ndt::Localizer& localizer, std::size_t i) const {
    const std::size_t scan = i % scans_.size();
    if (scan == 0) localizer.setInitialPose(poses_[0]);
    return localizer.localize(saw_ndt::viewOf(scans_[scan]), stamps_s_[scan]);
  }

 private:
  std::vector<Eigen::Isometry3d> poses_;
  std::vector<double> stamps_s_;
  std::vector<std::vector<saw_ndt::LidarPoint>> scans_;
};

struct Settings {
  int scan_count = 210;
  double period_ms = 25.0;
};

struct Times {
  std::vector<double> total_ms;
  std::size_t rejected = 0;
};

Times measure(const Drive& drive, const std::string& method, int threads, const Settings& settings,
              saw_ndt::ProgressBar& progress) {
  using Clock = std::chrono::steady_clock;
  saw_ndt::LocalizerOptions options;
  options.method = saw_ndt::LocalizationMethod::named(method);
  options.alignment.threads = threads;
  saw_ndt::Localizer localizer(saw_ndt::benchmarkMap(), options);
  const auto period =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double, std::milli>(settings.period_ms));
  Times times;
  Clock::time_point next = Clock::now();
  for (std::size_t i = 0; i < static_cast<std::size_t>(kScansBefore + settings.scan_count); ++i) {
    std::this_thread::sleep_until(next);
    next = std::max(next, Clock::now()) + period;  // a scan that is late delays those behind it
    const saw_ndt::LocalizationResult result = drive.localize(localizer, i);
    times.rejected += result.accepted() ? 0 : 1;
    if (i >= kScansBefore) times.total_ms.push_back(result.times.total_ms);
    progress.step();
  }
  return times;
}

std::vector<int> loopCounts(const std::vector<double>& values) {
  std::vector<int> counts;
  for (const double value : values) {
    if (value < 0.0 || value > 1000.0 || value != std::floor(value)) {
      throw saw_ndt::UsageError("option -beside: must be whole numbers from 0 to 1000");
    }
    counts.push_back(static_cast<int>(value));
  }
  return counts;
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  std::vector<double> beside;
  std::vector<std::string> methods;
  saw_ndt::AppOptions app(
      "busy_processor",
      "Localizes the scans of the benchmarks' drive in a map of the even ones, by one thread and by two, while so many "
      "endless loops run beside it, programs of their own, and prints a table: mean, 95th percentile and maximum of "
      "the milliseconds from a scan to its pose. The environment variable SAW_NDT_KITTI names a KITTI folder.");
  app.addOption("scans", &settings.scan_count, "N", "how many are measured of each");
  app.addOption("period-ms", &settings.period_ms, "MILLISECONDS",
                "from a scan to the next, where the last one is done");
  app.addOption("beside", &beside, "N,...", "numbers of endless loops (default: 0,1,2,4)");
  app.addOption("methods", &methods, "METHOD,...", "localization methods (default: weighted,classical)");
  return saw_ndt::runApp(argc, argv, app, [&] {
    if (settings.scan_count < 1) throw saw_ndt::UsageError("option -scans: must be 1 or more");
    if (settings.period_ms < 0.0) throw saw_ndt::UsageError("option -period-ms: must be 0 or more");
    if (beside.empty()) beside = {0, 1, 2, 4};
    if (methods.empty()) methods = {"weighted", "classical"};
    const std::vector<int> loop_counts = loopCounts(beside);
    const std::vector<int>& thread_counts = saw_ndt::benchmarkThreadCounts();
    for (const std::string& method : methods) {
      saw_ndt::checkedUsage([&] { return saw_ndt::LocalizationMethod::named(method); });
    }

    std::cout << saw_ndt::benchmarkSequenceDescription() << ", " << settings.scan_count << " scans each, one every "
              << settings.period_ms << " ms; total_ms, mean / P95 / max:\n\n| endless loops beside |";
    for (const std::string& method : methods) {
      for (const int threads : thread_counts) {
        std::cout << " `" << method << "`, " << threads << (threads == 1 ? " thread |" : " threads |");
      }
    }
    std::cout << "\n|---|";
    for (std::size_t column = 0; column < methods.size() * thread_counts.size(); ++column) std::cout << "---|";
    std::cout << std::fixed << std::setprecision(1) << std::endl;

    const Drive drive;
    const auto cells = loop_counts.size() * methods.size() * thread_counts.size();
    saw_ndt::ProgressBar progress(cells * static_cast<std::size_t>(kScansBefore + settings.scan_count));
    std::size_t rejected = 0;
    for (const int loop_count : loop_counts) {
      const EndlessLoops loops(loop_count);
      std::cout << "| " << loop_count << " |";
      for (const std::string& method : methods) {
        for (const int threads : thread_counts) {
          const Times times = measure(drive, method, threads, settings, progress);
          const saw_ndt::internal::DurationStatistics statistics =
              saw_ndt::internal::durationStatistics(times.total_ms);
          std::cout << " " << statistics.mean << " / " << statistics.p95 << " / " << statistics.max << " |";
          rejected += times.rejected;
        }
      }
      std::cout << std::endl;
    }
    std::cout << "\nScans rejected: " << rejected << "\n";
  });
}
