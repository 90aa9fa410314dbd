#include <algorithm>
#include <iostream>

#include "app_options.h"
#include "bin_fields_argument.h"
#include "report/segmentation_score.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/io/kitti.h"
#include "saw_ndt/io/point_cloud_file.h"
#include "saw_ndt/segmentation/scan_segmenter.h"
#include "segmentation_options.h"

namespace {

constexpr char kDescription[] =
    "Segments a scan in its range image and writes every one of its points, with all fields that its file has, and a "
    "label: 0 noise, 1 ground, 2 non-ground. With -labels the ground is scored against SemanticKITTI classes and one "
    "JSON object is printed: "
    "precision, recall, f1 and iou over the points of known class (0 unlabelled and 1 outlier are left out), "
    "noise_share "
    "among all points, and the counts behind them.";

std::size_t countOf(const std::vector<saw_ndt::StructuralLabel>& labels, saw_ndt::StructuralLabel label) {
  return static_cast<std::size_t>(std::count(labels.begin(), labels.end(), label));
}

}  // namespace

int main(int argc, char** argv) {
  std::string scan_file, pcd_file, label_file;
  saw_ndt::SegmentationArguments segmentation;
  saw_ndt::BinFieldsArgument bin_fields;
  saw_ndt::AppOptions app("saw_ndt_segment", kDescription);
  app.addPositional("SCAN", &scan_file, "one scan in the LiDAR frame, .bin (KITTI), .pcd or .ply");
  app.addPositional("OUT.pcd", &pcd_file, "labelled cloud to write");
  app.addOption("labels", &label_file, "FILE.label", "SemanticKITTI classes of the scan's points");
  bin_fields.addTo(app);
  segmentation.addTo(app);

  return saw_ndt::runApp(argc, argv, app, [&] {
    segmentation.stated();
    const saw_ndt::ScanPoints scan = saw_ndt::readScanPoints(scan_file, bin_fields.value());
    std::vector<std::uint16_t> classes;
    if (!label_file.empty()) {
      classes = saw_ndt::readSemanticKittiLabels(label_file);
      if (classes.size() != scan.points.size()) {
        throw saw_ndt::Error(label_file, "",
                             std::to_string(classes.size()) + " labels, where " + scan_file + " has " +
                                 std::to_string(scan.points.size()) + " points");
      }
    }
    saw_ndt::ScanSegmenter segmenter(segmentation.learnedFrom({scan}));
    std::vector<saw_ndt::StructuralLabel> labels;
    segmenter.segment(saw_ndt::viewOf(scan), labels, app.threads());
    saw_ndt::writeLabelledScan(pcd_file, scan_file, labels, bin_fields.value());
    if (!label_file.empty()) {
      std::cout << saw_ndt::toJsonText(saw_ndt::scoreGround(labels, classes));
      return;
    }
    std::cout << pcd_file << ": " << labels.size() << " points, " << countOf(labels, saw_ndt::StructuralLabel::GROUND)
              << " ground, " << countOf(labels, saw_ndt::StructuralLabel::NON_GROUND) << " non-ground, "
              << countOf(labels, saw_ndt::StructuralLabel::NOISE) << " noise\n";
  });
}
