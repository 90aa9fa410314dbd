#include <iostream>
#include <limits>

#include "app_options.h"
#include "common/atomic_output.h"
#include "saw_ndt/io/kitti.h"
#include "saw_ndt/io/polygon_file.h"
#include "saw_ndt/io/trajectory.h"
#include "saw_ndt/map/map_crop.h"

namespace {

constexpr char kDescription[] =
    "Writes the part of a map that lies in a box, in a polygon or around a trajectory (one of them): the voxels whose "
    "centres lie there, whole and unchanged. Boxes, ranges and polygons side by side share no voxel: such parts are "
    "the whole map again when saw_ndt_map_merge puts them together. A part tells the points that it holds, but the "
    "scans of the whole map, for which of them left no points is not known.";

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Where a cropped map lies, as the command line states it.
struct RegionArguments {
  std::vector<double> box_m, z_range_m;
  std::string polygon_file, trajectory_file, calibration_file;
  double radius_m = 50.0;

  void addTo(saw_ndt::AppOptions& app) {
    app.addOption("box", &box_m, "X,Y,X,Y",
                  "least, then greatest corner, metres in the map; voxels on the greatest side do not belong");
    app.addOption("polygon", &polygon_file, "FILE",
                  "vertices of a simple polygon, lines of `x y` or CSV, metres in the map");
    app.addOption("around", &trajectory_file, "TRAJECTORY",
                  "poses in the map as TUM, CSV or KITTI; the line through them is what counts");
    app.addOption("radius", &radius_m, "METRES", "greatest horizontal distance from -around");
    app.addOption(
        "calib", &calibration_file, "FILE",
        "calib.txt with Tr (LiDAR to left camera), where -around is a KITTI file of poses of the left camera; "
        "without it poses are of the LiDAR");
    app.addOption("z-range", &z_range_m, "Z,Z", "least and greatest height, besides, metres in the map");
  }

  saw_ndt::MapRegion horizontal() const {
    if (!box_m.empty()) {
      return saw_ndt::checkedUsage([&] {
        return saw_ndt::boxRegion({box_m[0], box_m[1], -kInfinity}, {box_m[2], box_m[3], kInfinity});
      });
    }
    if (!polygon_file.empty()) return saw_ndt::polygonRegion(saw_ndt::readPolygon(polygon_file));
    const saw_ndt::Trajectory trajectory = saw_ndt::readTrajectory(trajectory_file);
    if (!calibration_file.empty() && trajectory.format != saw_ndt::TrajectoryFormat::KITTI) {
      throw saw_ndt::UsageError("-calib goes with a KITTI file, which " + trajectory_file + " is not");
    }
    const Eigen::Isometry3d Tr =
        calibration_file.empty() ? Eigen::Isometry3d::Identity() : saw_ndt::readKittiCalibration(calibration_file);
    std::vector<Eigen::Vector2d> points_m;
    for (const saw_ndt::StampedPose& pose : trajectory.poses) {
      points_m.push_back(saw_ndt::lidarPose(pose.T_map_body, Tr).translation().head<2>());
    }
    return saw_ndt::checkedUsage([&] { return saw_ndt::regionAround(points_m, radius_m); });
  }

  saw_ndt::MapRegion region(const saw_ndt::AppOptions& app) const {
    const int ways = static_cast<int>(app.isGiven("box")) + static_cast<int>(app.isGiven("polygon")) +
                     static_cast<int>(app.isGiven("around"));
    if (ways != 1) throw saw_ndt::UsageError("one of -box, -polygon and -around is needed");
    for (const std::string name : {"radius", "calib"}) {
      if (app.isGiven(name) && !app.isGiven("around")) throw saw_ndt::UsageError("-" + name + " goes with -around");
    }
    if (!box_m.empty() && box_m.size() != 4) throw saw_ndt::UsageError("option -box: 4 numbers are needed");
    const saw_ndt::MapRegion inside = horizontal();
    if (z_range_m.empty()) return inside;
    if (z_range_m.size() != 2) throw saw_ndt::UsageError("option -z-range: 2 numbers are needed");
    const saw_ndt::MapRegion at_height = saw_ndt::checkedUsage([&] {
      return saw_ndt::boxRegion({-kInfinity, -kInfinity, z_range_m[0]}, {kInfinity, kInfinity, z_range_m[1]});
    });
    return saw_ndt::commonRegion(at_height, inside);
  }
};

}  // namespace

int main(int argc, char** argv) {
  std::string map_file, cropped_file;
  RegionArguments arguments;
  saw_ndt::AppOptions app("saw_ndt_map_crop", kDescription);
  app.addPositional("MAP", &map_file, "map file");
  app.addPositional("OUT", &cropped_file, "map file to write; may be MAP");
  arguments.addTo(app);

  return saw_ndt::runApp(argc, argv, app, [&] {
    const saw_ndt::MapRegion region = arguments.region(app);
    // Found out before the long work: whether the map can be written. This leaves nothing behind.
    { const saw_ndt::internal::AtomicOutput probe(cropped_file); }
    const saw_ndt::CroppedMap cropped = saw_ndt::cropMapFile(map_file, region, cropped_file, app.threads());
    std::cout << cropped_file << ": " << cropped.voxel_count << " voxels of " << cropped.origin.resolution_m
              << " m with " << cropped.origin.point_count << " of " << cropped.point_count_before << " points\n";
  });
}
