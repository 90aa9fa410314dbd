// Draws the range images of scans one above the other, to see how alike simulated and real ones are.

#include <filesystem>

#include "app_options.h"
#include "report/gnuplot.h"
#include "saw_ndt/io/kitti.h"
#include "saw_ndt/io/scan_file.h"
#include "saw_ndt/pcl/cloud_view.h"
#include "segmentation/range_image.h"
#include "segmentation_options.h"

namespace {

/// Columns of a data block: azimuth to the left of straight ahead (degrees), row from the top, range (m).
std::vector<std::vector<double>> pixelsOf(const std::string& scan_file, const saw_ndt::SensorModel& sensor) {
  const auto cloud = saw_ndt::readKittiScan(scan_file);
  saw_ndt::internal::RangeImage image;
  image.project(saw_ndt::viewOf(cloud), sensor);
  std::vector<std::vector<double>> columns(3);
  for (int row = 0; row < image.rows(); ++row) {
    for (int i = 0; i < image.columns(); ++i) {
      // Straight ahead in the middle, left on the left: columns count counter-clockwise from straight ahead.
      const int column = (image.columns() + image.columns() / 2 - i) % image.columns();
      const float range_m = image.range()[static_cast<std::size_t>(row * image.columns() + column)];
      columns[0].push_back(180.0 - 360.0 * i / image.columns());
      columns[1].push_back(row);
      columns[2].push_back(range_m > 0.0f ? range_m : 1.0);
    }
  }
  return columns;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> scans, titles;
  std::string output;
  saw_ndt::SegmentationArguments segmentation;
  saw_ndt::AppOptions app("range_image_picture",
                          "Draws the range images of scans one above the other into a PNG file; black: no return.");
  app.addPositionalList("SCAN", &scans, "Velodyne scans as KITTI's .bin files");
  app.addOption("output", &output, "FILE.png", "the picture; must be given");
  app.addOption("titles", &titles, "TITLE,...", "a title for each scan (default: none)");
  segmentation.addTo(app);

  return saw_ndt::runApp(argc, argv, app, [&] {
    const std::filesystem::path file = output;
    if (file.extension() != ".png") throw saw_ndt::UsageError("option -output: must name a .png file");
    titles.resize(scans.size());
    const saw_ndt::SensorModel sensor = segmentation.learnedFrom({saw_ndt::readScanPoints(scans.front())}).sensor;
    constexpr int kPanelHeight_px = 150;
    saw_ndt::GnuplotPicture picture;
    picture.name = file.stem().string();
    picture.width_px = 1100;
    picture.height_px = kPanelHeight_px * static_cast<int>(scans.size()) + 60;
    picture.many_points = true;
    picture.commands =
        "set multiplot layout " + std::to_string(scans.size()) +
        ",1\nunset key\nset logscale cb\nset cbrange [2:80]\nset cblabel 'range (m)'\nset cbtics (2, 5, 10, 20, 40, "
        "80)\n"
        "set palette defined (0 'black', 0.001 '#30123b', 0.2 '#4686fb', 0.4 '#1ae4b6', 0.6 '#a4fc3c', 0.8 '#fb7e21', "
        "1 "
        "'#7a0403')\nset xrange [180:-180]\nset xtics 45\nset yrange [" +
        std::to_string(sensor.rows() - 1) + ".5:-0.5]\nset ytics 21\nset ylabel 'row'\n";
    for (std::size_t i = 0; i < scans.size(); ++i) {
      const std::string block = "$image" + std::to_string(i);
      picture.data += saw_ndt::gnuplotData(block, pixelsOf(scans[i], sensor));
      if (i + 1 == scans.size()) picture.commands += "set xlabel 'azimuth (degrees, left of straight ahead)'\n";
      picture.commands += "set title " + saw_ndt::gnuplotQuoted(titles[i]) + " offset 0,-0.6\nplot " + block +
                          " using 1:2:3 with image\n";
    }
    picture.commands += "unset multiplot\n";
    saw_ndt::drawPicture(picture, file.has_parent_path() ? file.parent_path() : ".");
  });
}
