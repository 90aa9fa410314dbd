#include <iostream>

#include "app_options.h"
#include "io/staged_output.h"
#include "output_folder.h"
#include "recording_argument.h"
#include "report/benchmark_output.h"
#include "report/benchmark_report.h"
#include "saw_ndt/drives/scan_selection.h"
#include "segmentation_options.h"
#include "stage_progress.h"

namespace {

using saw_ndt::MapDrive;

constexpr char kDescription[] =
    "Localizes drives by several methods, which take turns scan by scan, and compares them as the paper's Table I "
    "does: "
    "run times, errors against the reference poses, macro averages. Writes table.md, table.csv, table.json, "
    "report.html "
    "(with pictures, where gnuplot is installed, that are in plots/ as well) and, for each sequence and method, what "
    "saw_ndt_localize writes, into the folder of -output; table.md is printed, too. In "
    "a map of the same drive a scan finds its own points again, as in the paper, unless -map-scans and -scans select "
    "different ones; a map of another drive along the same streets is the harder test. The reference pose of the first "
    "scan is the initial pose.";

std::vector<MapDrive> drivesOf(const std::string& word, bool other_given) {
  if (word == "other") return {MapDrive::OTHER};
  if (word == "both" || (word.empty() && other_given)) return {MapDrive::SAME, MapDrive::OTHER};
  return {MapDrive::SAME};
}

std::vector<saw_ndt::BenchmarkDrive> openDrives(const std::vector<std::string>& folders,
                                                const std::vector<std::string>& map_folders,
                                                const saw_ndt::RecordingArgument& recordings) {
  if (!map_folders.empty() && map_folders.size() != folders.size()) {
    throw saw_ndt::UsageError("option -map-from: " + std::to_string(map_folders.size()) + " drives, where " +
                              std::to_string(folders.size()) + " are to be localized: one for each is needed");
  }
  std::vector<saw_ndt::BenchmarkDrive> drives;
  for (std::size_t i = 0; i < folders.size(); ++i) {
    drives.push_back({recordings.open(folders[i]), {}});
    if (!map_folders.empty()) drives.back().other = recordings.open(map_folders[i]);
  }
  return drives;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> folders, map_folders;
  std::string out_dir, drives;
  bool with_paper = false;
  saw_ndt::BenchmarkOptions options;
  saw_ndt::SegmentationArguments segmentation;
  saw_ndt::RecordingArgument recordings;
  saw_ndt::AppOptions app("saw_ndt_benchmark", kDescription);
  app.addPositionalList("SEQUENCE", &folders,
                        std::string(saw_ndt::RecordingArgument::kKinds) + "; with reference poses");
  app.addOption("output", &out_dir, "DIR", "folder for the results, made where it is missing; must be given");
  app.addOption("methods", &options.methods, "NAME,...",
                "methods to compare; pcl-ndt, PCL's own class, is another one and slow");
  app.addOption("map-from", &map_folders, "FOLDER,...",
                "for each SEQUENCE another drive along the same streets, whose poses share the frame of its poses");
  app.addOption("drives", &drives, "WORD",
                "maps of the `same` drive, of the `other` one (-map-from), or of `both` (default: both with -map-from, "
                "else same)");
  app.addOption("map-scans", &options.map_scans, "SLICE", "scans of the maps, first:last:step as in Python");
  app.addOption("scans", &options.scans, "SLICE", "scans to localize");
  app.addOption("skip", &options.skip_s, "SECONDS", "time at the start that the errors leave out; 0 for short drives");
  app.addOption("resolution", &options.resolution_m, "METRES", "edge of the voxels of the maps");
  app.addFlag("paper", &with_paper, "add the paper's Table I beside sequences named 00, 01 and 03");
  recordings.addTo(app, false);
  segmentation.addTo(app);

  return saw_ndt::runApp(argc, argv, app, [&] {
    if (out_dir.empty()) throw saw_ndt::UsageError("option -output is needed");
    if (!drives.empty() && drives != "same" && drives != "other" && drives != "both") {
      throw saw_ndt::UsageError("option -drives: '" + drives + "' is none of same, other, both");
    }
    options.drives = drivesOf(drives, !map_folders.empty());
    options.localizer.segmentation = segmentation.stated();
    options.localizer.alignment.threads = app.threads();
    const auto open = [&] {
      return saw_ndt::checkedUsage(
          [&] { return saw_ndt::Benchmark(openDrives(folders, map_folders, recordings), options); });
    };
    open();  // what is wrong with the command line is said before scans are read
    const std::unique_ptr<saw_ndt::Recording> first = recordings.open(folders.front());
    options.localizer.segmentation = segmentation.learnedFrom(
        saw_ndt::firstScans(*first->scans(saw_ndt::parseScanSelection(options.scans, first->scanCount()))));
    const saw_ndt::Benchmark benchmark = open();
    const saw_ndt::RunRecord record = saw_ndt::recordRun({argv, argv + argc}, app.threads());

    saw_ndt::OutputFolder folder(out_dir);
    saw_ndt::StageProgress progress(app.name(), benchmark.stageCount());
    const std::vector<saw_ndt::BenchmarkRun> runs =
        benchmark.run({[&](const std::string& description, std::size_t steps) { progress.begin(description, steps); },
                       [&] { progress.step(); }});
    const std::vector<saw_ndt::BenchmarkTable> tables = saw_ndt::benchmarkTables(runs);
    const saw_ndt::BenchmarkText text = saw_ndt::benchmarkText(tables, record, with_paper);
    saw_ndt::internal::StagedOutput staged(folder.path());
    saw_ndt::writeBenchmark(staged.folder(), runs, tables, text);
    const std::string note = saw_ndt::writeBenchmarkReport(staged.folder(), runs, text);
    staged.commit();
    folder.keep();
    if (!note.empty()) std::cerr << app.name() << ": " << note << '\n';
    std::cout << saw_ndt::toMarkdown(text);
  });
}
