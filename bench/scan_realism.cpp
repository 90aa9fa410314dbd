// Prints what scans of drives look like, beside the span of real drives that they should lie in.

#include <algorithm>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <map>
#include <sstream>

#include "app_options.h"
#include "evaluation/statistics.h"
#include "progress_bar.h"
#include "report/scan_statistics.h"
#include "saw_ndt/drives/kitti_sequence.h"
#include "saw_ndt/drives/scan_selection.h"
#include "saw_ndt/pcl/cloud_view.h"
#include "segmentation_options.h"

namespace {

/// The values of each figure over the scans of a drive, and the figures' names in order.
struct DriveFigures {
  std::map<std::string, std::vector<double>> values;
  std::vector<std::string> names;
};

DriveFigures figuresOf(const std::string& folder, const std::string& scans, saw_ndt::ScanSegmenter& segmenter) {
  const saw_ndt::KittiSequence sequence(folder);
  DriveFigures figures;
  for (const int scan : saw_ndt::parseScanSelection(scans, sequence.scanCount())) {
    const auto cloud = sequence.readScan(scan);
    std::vector<std::uint16_t> classes;
    if (std::filesystem::exists(sequence.labelPath(scan))) classes = sequence.readLabels(scan);
    for (const auto& [name, value] : saw_ndt::scanStatistics(saw_ndt::viewOf(cloud), classes, segmenter)) {
      std::vector<double>& values = figures.values[name];
      if (values.empty()) figures.names.push_back(name);
      values.push_back(value);
    }
  }
  return figures;
}

std::string text(double value) {
  std::ostringstream out;
  out << std::fixed << std::setprecision(value < 0.1 ? 4 : value < 2.0 ? 3 : value < 100.0 ? 1 : 0) << value;
  return out.str();
}

/// Where a value lies: inside the span, or by what share of the nearest end outside of it.
std::string judged(double value, double least, double greatest) {
  if (value >= least && value <= greatest) return text(value);
  const double end = value < least ? least : greatest;
  std::ostringstream out;
  out << "**" << text(value) << "** (" << std::showpos << std::fixed << std::setprecision(0)
      << 100.0 * (value - end) / end << " %)";
  return out.str();
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> drives, real_drives;
  std::string scans = "::10", real_scans = ":";
  saw_ndt::SegmentationArguments segmentation;
  saw_ndt::AppOptions app(
      "scan_realism",
      "Prints the median of figures of the scans of each SEQUENCE beside the least and the greatest value of all scans "
      "of real drives; what lies outside is bold, with its distance from the span's nearer end.");
  app.addPositionalList("SEQUENCE", &drives, "folder in KITTI layout, such as a simulated drive");
  app.addOption("real", &real_drives, "FOLDER,...", "real drives in KITTI layout; needed");
  app.addOption("scans", &scans, "SLICE", "scans of each SEQUENCE");
  app.addOption("real-scans", &real_scans, "SLICE", "scans of each real drive");
  segmentation.addTo(app);

  return saw_ndt::runApp(argc, argv, app, [&] {
    if (real_drives.empty()) throw saw_ndt::UsageError("option -real is needed");
    const saw_ndt::KittiSequence first(real_drives.front());
    saw_ndt::ScanSegmenter segmenter(segmentation.learnedFrom(
        saw_ndt::firstScans(*first.scans(saw_ndt::parseScanSelection(real_scans, first.scanCount())))));
    saw_ndt::ProgressBar progress(real_drives.size() + drives.size());

    std::map<std::string, std::vector<double>> real_values;
    for (const std::string& folder : real_drives) {
      for (const auto& [name, values] : figuresOf(folder, real_scans, segmenter).values) {
        real_values[name].insert(real_values[name].end(), values.begin(), values.end());
      }
      progress.step();
    }
    std::vector<DriveFigures> figures;
    std::string header = "| figure | real least | real greatest |", rule = "|---|---|---|";
    for (const std::string& folder : drives) {
      figures.push_back(figuresOf(folder, scans, segmenter));
      header += " " + saw_ndt::KittiSequence(folder).name() + " |";
      rule += "---|";
      progress.step();
    }
    std::cout << header << "\n" << rule << "\n";
    for (const std::string& name : figures.front().names) {
      const auto found = real_values.find(name);
      if (found == real_values.end()) continue;
      const auto [least, greatest] = std::minmax_element(found->second.begin(), found->second.end());
      std::cout << "| " << name << " | " << text(*least) << " | " << text(*greatest) << " |";
      for (const DriveFigures& drive : figures) {
        const auto values = drive.values.find(name);
        std::cout << " "
                  << (values == drive.values.end()
                          ? ""
                          : judged(saw_ndt::internal::median(values->second), *least, *greatest))
                  << " |";
      }
      std::cout << "\n";
    }
  });
}
