#include <algorithm>
#include <iostream>

#include "app_options.h"
#include "report/segmentation_score.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/io/kitti.h"
#include "saw_ndt/io/point_cloud_file.h"
#include "saw_ndt/pcl/range_image_segmentation.h"
#include "segmentation_options.h"

namespace {

constexpr char kDescription[] =
    "Segments a scan in its range image and writes every one of its points with a label: 0 noise, 1 ground, "
    "2 non-ground. With -labels the ground is scored against SemanticKITTI classes and one JSON object is printed: "
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
  saw_ndt::AppOptions app("saw_ndt_segment", kDescription);
  app.addPositional("SCAN", &scan_file, "one scan in the LiDAR frame, .bin (KITTI) or .pcd");
  app.addPositional("OUT.pcd", &pcd_file, "labelled cloud to write");
  app.addOption("labels", &label_file, "FILE.label", "SemanticKITTI classes of the scan's points");
  segmentation.addTo(app);

  return saw_ndt::runApp(argc, argv, app, [&] {
    saw_ndt::RangeImageSegmentation<pcl::PointXYZ> filter;
    filter.setOptions(segmentation.options());
    const auto scan =
        pcl::make_shared<pcl::PointCloud<pcl::PointXYZ>>(saw_ndt::readPointCloud<pcl::PointXYZ>(scan_file));
    std::vector<std::uint16_t> classes;
    if (!label_file.empty()) {
      classes = saw_ndt::readSemanticKittiLabels(label_file);
      if (classes.size() != scan->size()) {
        throw saw_ndt::Error(label_file, "",
                             std::to_string(classes.size()) + " labels, where " + scan_file + " has " +
                                 std::to_string(scan->size()) + " points");
      }
    }
    filter.setInputCloud(scan);
    pcl::PointCloud<pcl::PointXYZL> labelled;
    filter.segment(labelled);
    saw_ndt::writePcd(pcd_file, labelled);
    const std::vector<saw_ndt::StructuralLabel>& labels = filter.getLabels();
    if (!label_file.empty()) {
      std::cout << saw_ndt::toJsonText(saw_ndt::scoreGround(labels, classes));
      return;
    }
    std::cout << pcd_file << ": " << labels.size() << " points, " << countOf(labels, saw_ndt::StructuralLabel::GROUND)
              << " ground, " << countOf(labels, saw_ndt::StructuralLabel::NON_GROUND) << " non-ground, "
              << countOf(labels, saw_ndt::StructuralLabel::NOISE) << " noise\n";
  });
}
