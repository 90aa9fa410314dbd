// Tells how precise each method is, without trusting reference poses: halves of scans against halves of the map, and
// the sharpness of the map that the found poses give; and, where a drive with exact poses has a map of another drive,
// the error itself.

#include <cmath>
#include <cstdio>
#include <iostream>
#include <random>

#include "app_options.h"
#include "evaluation/statistics.h"
#include "precision_clip.h"
#include "progress_bar.h"
#include "report/benchmark.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/drives/drive_localization.h"
#include "saw_ndt/drives/drive_map.h"

namespace {

using saw_ndt::HalvesError;

constexpr char kDescription[] =
    "Prints how precise methods are. For each SEQUENCE: root mean square differences of the poses of two halves of "
    "each "
    "odd scan, aligned from the reference pose with the maps of every fourth scan from 0 and from 2, over the root of "
    "two, with the 95 % interval of a bootstrap over the scans; and the mean thickness of planar voxels in the map "
    "that "
    "the poses found for whole odd scans in the map of the even ones give. With -map-from, for drives whose poses are "
    "exact: the error of localizing each drive in the map of the other.";

double rootMeanSquare(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

// The root mean square of each sequence, averaged over the sequences.
double meanOf(const std::vector<std::vector<double>>& sequences) {
  double sum = 0.0;
  for (const std::vector<double>& values : sequences) sum += rootMeanSquare(values);
  return sum / static_cast<double>(sequences.size());
}

// "value (low to high)", the 95 % interval of a bootstrap that draws the scans of each sequence anew.
std::string withInterval(const std::vector<std::vector<double>>& sequences, double unit, int digits) {
  constexpr int kDraws = 2000;
  std::mt19937 engine(1);
  std::vector<double> means;
  std::vector<std::vector<double>> drawn = sequences;
  for (int draw = 0; draw < kDraws; ++draw) {
    for (std::size_t s = 0; s < sequences.size(); ++s) {
      std::uniform_int_distribution<std::size_t> any(0, sequences[s].size() - 1);
      for (double& value : drawn[s]) value = sequences[s][any(engine)];
    }
    means.push_back(meanOf(drawn));
  }
  char text[80];
  std::snprintf(text, sizeof text, "%.*f (%.*f to %.*f)", digits, unit * meanOf(sequences), digits,
                unit * saw_ndt::internal::percentile(means, 2.5), digits,
                unit * saw_ndt::internal::percentile(means, 97.5));
  return text;
}

// One row a method: a column for each sequence and one for all of them.
void printTable(const std::string& title, const std::vector<std::string>& names,
                const std::vector<std::string>& methods,
                const std::vector<std::vector<std::vector<double>>>& of_methods, double unit, int digits) {
  std::cout << "\n" << title << "\n\n| method |";
  for (const std::string& name : names) std::cout << " " << name << " |";
  std::cout << " mean | over " << methods.back() << " |\n|---|";
  for (std::size_t i = 0; i < names.size() + 2; ++i) std::cout << "---|";
  std::cout << "\n";
  for (std::size_t m = 0; m < methods.size(); ++m) {
    std::cout << "| " << methods[m] << " |";
    for (const std::vector<double>& values : of_methods[m])
      std::cout << " " << withInterval({values}, unit, digits) << " |";
    char ratio[20];
    std::snprintf(ratio, sizeof ratio, "%.2f", meanOf(of_methods[m]) / meanOf(of_methods.back()));
    std::cout << " " << withInterval(of_methods[m], unit, digits) << " | " << ratio << " |\n";
  }
}

struct Arguments {
  std::vector<std::string> sequences, map_from, methods;
  double displacement_m = 0.0, skip_s = 3.0;
  int frames = 1, threads = 1;
};

using OfMethods = std::vector<std::vector<std::vector<double>>>;  // method, sequence, scan

void printHalves(const Arguments& arguments, const std::vector<std::string>& names) {
  const std::size_t methods = arguments.methods.size();
  OfMethods position_m(methods), yaw_deg(methods), thickness_m(methods + 1);
  for (std::size_t s = 0; s < names.size(); ++s) {
    const saw_ndt::KittiSequence sequence(arguments.sequences[s]);
    saw_ndt::ProgressBar progress(static_cast<std::size_t>(sequence.scanCount() / 2 * arguments.frames) * methods);
    for (int frame = 0; frame < arguments.frames; ++frame) {
      const std::vector<saw_ndt::LabelledScan> scans = saw_ndt::labelledScans(sequence, frame, arguments.threads);
      if (scans.size() < 4) throw saw_ndt::Error(arguments.sequences[s], "", "has fewer than 4 scans");
      for (std::size_t m = 0; m < methods; ++m) {
        for (OfMethods* of : {&position_m, &yaw_deg, &thickness_m}) (*of)[m].resize(names.size());
        const std::string& method = arguments.methods[m];
        for (const HalvesError& error : saw_ndt::halvesErrors(scans, method, arguments.displacement_m,
                                                              arguments.threads, [&] { progress.step(); })) {
          position_m[m][s].push_back(error.position_m);
          yaw_deg[m][s].push_back(error.yaw_deg);
        }
        thickness_m[m][s].push_back(saw_ndt::mapThickness(scans, method, arguments.threads));
      }
      thickness_m.back().resize(names.size());
      thickness_m.back()[s].push_back(saw_ndt::mapThickness(scans, "", arguments.threads));
    }
  }
  printTable("Halves, position mm:", names, arguments.methods, position_m, 1e3, 2);
  printTable("Halves, yaw deg:", names, arguments.methods, yaw_deg, 1.0, 4);
  std::vector<std::string> with_reference = arguments.methods;
  with_reference.emplace_back("reference poses");
  std::cout << "\nMean thickness of planar voxels mm:\n\n| poses |";
  for (const std::string& name : names) std::cout << " " << name << " |";
  std::cout << "\n|---|";
  for (std::size_t i = 0; i < names.size(); ++i) std::cout << "---|";
  for (std::size_t m = 0; m < with_reference.size(); ++m) {
    std::cout << "\n| " << with_reference[m] << " |";
    for (const std::vector<double>& values : thickness_m[m])
      std::printf(" %.3f |", 1e3 * saw_ndt::internal::mean(values));
    std::fflush(stdout);
  }
  std::cout << "\n";
}

void printExactErrors(const Arguments& arguments, const std::vector<std::string>& names) {
  OfMethods position_m(arguments.methods.size()), yaw_deg(arguments.methods.size());
  for (std::size_t s = 0; s < names.size(); ++s) {
    const saw_ndt::KittiSequence sequence(arguments.sequences[s]), other(arguments.map_from[s]);
    saw_ndt::DriveMapOptions map_options;
    map_options.threads = arguments.threads;
    const auto all = [](const saw_ndt::KittiSequence& of) {
      std::vector<int> numbers;
      for (int i = 0; i < of.scanCount(); ++i) numbers.push_back(i);
      return numbers;
    };
    const saw_ndt::WeightedVoxelMap map = saw_ndt::buildDriveMap(*other.scans(all(other)), map_options).build();
    for (std::size_t m = 0; m < arguments.methods.size(); ++m) {
      position_m[m].resize(names.size());
      yaw_deg[m].resize(names.size());
      if (arguments.methods[m] == saw_ndt::kPclNdtMethod) {
        throw saw_ndt::UsageError("option -methods: " + arguments.methods[m] + " has no exact errors here");
      }
      saw_ndt::LocalizerOptions options;
      options.method = saw_ndt::LocalizationMethod::named(arguments.methods[m]);
      options.alignment.threads = arguments.threads;
      saw_ndt::Localizer localizer(map, options);
      localizer.setInitialPose(sequence.posesLidar().front());
      saw_ndt::ProgressBar progress(static_cast<std::size_t>(sequence.scanCount()));
      const saw_ndt::DriveLocalization run = saw_ndt::localizeDrive(localizer, *sequence.scans(all(sequence)),
                                                                    [&](const auto&, const auto&) { progress.step(); });
      for (std::size_t i = 0; i < run.results.size(); ++i) {
        if (run.results[i].stamp_s - run.results.front().stamp_s < arguments.skip_s) continue;
        const saw_ndt::PoseError error =
            saw_ndt::poseError(run.T_map_lidar_reference[i].value(), run.results[i].T_map_base);
        position_m[m][s].push_back(error.position_m);
        yaw_deg[m][s].push_back(error.yaw_deg);
      }
    }
  }
  printTable("Exact error in the map of another drive, position mm (root mean square):", names, arguments.methods,
             position_m, 1e3, 2);
  printTable("Exact error in the map of another drive, yaw deg (root mean square):", names, arguments.methods, yaw_deg,
             1.0, 4);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  arguments.methods = saw_ndt::LocalizationMethod::names();
  saw_ndt::AppOptions app("precision_benchmark", kDescription);
  app.addPositionalList("SEQUENCE", &arguments.sequences, "folders in KITTI layout, with reference poses");
  app.addOption("methods", &arguments.methods, "NAME,...",
                "methods, pcl-ndt among them; tables state ratios over the last one");
  app.addOption("map-from", &arguments.map_from, "FOLDER,...",
                "for each SEQUENCE another drive along the same way; both have exact poses");
  app.addOption("frames", &arguments.frames, "N",
                "map frames to average the halves over: voxels cut the scene elsewhere");
  app.addOption("displacement", &arguments.displacement_m, "METRES",
                "how far to either side of the reference pose the halves start");
  app.addOption("skip", &arguments.skip_s, "SECONDS", "time at the start of a drive that exact errors leave out");
  return saw_ndt::runApp(argc, argv, app, [&] {
    if (arguments.frames < 1) throw saw_ndt::UsageError("option -frames: must be 1 or more");
    if (!arguments.map_from.empty() && arguments.map_from.size() != arguments.sequences.size()) {
      throw saw_ndt::UsageError("option -map-from: as many folders are needed as SEQUENCE has");
    }
    arguments.threads = app.threads();
    std::vector<std::string> names;
    for (const std::string& folder : arguments.sequences) names.push_back(saw_ndt::KittiSequence(folder).name());
    if (arguments.map_from.empty()) {
      printHalves(arguments, names);
    } else {
      printExactErrors(arguments, names);
    }
  });
}
