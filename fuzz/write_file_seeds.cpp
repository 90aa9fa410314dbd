#include <cmath>
#include <fstream>
#include <sstream>

#include "io/message_bytes.h"
#include "io/velodyne_calibration_text.h"
#include "map/map_metadata.h"
#include "saw_ndt/io/kitti.h"
#include "saw_ndt/io/point_cloud_file.h"
#include "saw_ndt/io/trajectory.h"
#include "saw_ndt/segmentation/segmentation_options.h"
#include "seeds.h"

namespace saw_ndt {
namespace {

namespace fs = std::filesystem;
using internal::bytesOf;

/// Points of a turn of a few beams, as rows of x y z and more numbers.
std::vector<std::vector<float>> turn(int columns) {
  std::vector<std::vector<float>> rows;
  for (int ring = 0; ring < 4; ++ring) {
    for (int step = 0; step < 24; ++step) {
      const float azimuth = 0.26F * static_cast<float>(step), height = 0.4F * static_cast<float>(ring) - 1.5F;
      std::vector<float> row = {8.0F * std::cos(azimuth), 8.0F * std::sin(azimuth), height, 0.25F};
      if (columns > 4) row.push_back(static_cast<float>(ring));
      if (columns > 5) row.push_back(0.004F * static_cast<float>(step));
      rows.push_back(row);
    }
  }
  return rows;
}

std::string binaryRows(int columns) {
  std::string bytes;
  for (const std::vector<float>& row : turn(columns)) bytes += internal::floatBytes(row);
  return bytes;
}

std::string textRows(int columns, std::size_t count) {
  std::ostringstream text;
  const auto rows = turn(columns);
  for (std::size_t i = 0; i < count; ++i) {
    for (const float value : rows[i]) text << value << ' ';
    text << '\n';
  }
  return text.str();
}

void writeScans(const SeedFolder& seeds) {
  const char* const modes[] = {"\0", "\1", "\2", "\3"};
  for (int mode = 0; mode < 4; ++mode) {
    const int columns = mode == 0 ? 5 : mode + 3;
    seeds.add("scan_bin", "columns" + std::to_string(mode), std::string(modes[mode], 1) + binaryRows(columns));
  }
  const std::string fields =
      "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z intensity ring time\nSIZE 4 4 4 4 4 4\nTYPE F F F F F F\n"
      "COUNT 1 1 1 1 1 1\nWIDTH 24\nHEIGHT 4\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 96\n";
  seeds.add("cloud_pcd", "ascii", fields + "DATA ascii\n" + textRows(6, 96));
  seeds.add("cloud_pcd", "binary", fields + "DATA binary\n" + binaryRows(6));
  pcl::PointCloud<pcl::PointXYZL> cloud;
  for (const std::vector<float>& row : turn(4)) {
    pcl::PointXYZL point;
    point.getVector3fMap() << row[0], row[1], row[2];
    point.label = cloud.size() % 3;
    cloud.push_back(point);
  }
  writePcd(seeds.fileFor("cloud_pcd", "compressed"), cloud);

  const auto ply = [](const std::string& format) {
    return "ply\nformat " + format +
           " 1.0\ncomment a turn\nelement vertex 12\nproperty float x\nproperty float y\nproperty float z\n"
           "property float intensity\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  };
  seeds.add("cloud_ply", "ascii", ply("ascii") + textRows(4, 12) + "3 0 1 2\n");
  const std::string vertices = binaryRows(4).substr(0, 12 * 16), face = "\3" + std::string(12, '\0');
  seeds.add("cloud_ply", "little_endian", ply("binary_little_endian") + vertices + face);
  seeds.add("cloud_ply", "big_endian", ply("binary_big_endian") + vertices + face);
}

void writeKitti(const SeedFolder& seeds) {
  const auto add = [&](char reader, const std::string& name, const std::string& content) {
    seeds.add("kitti_files", name, std::string(1, reader) + content);
  };
  const std::string rotation = "0 -1 0 0 0 -1 1 0 0";
  add(0, "calib", "P0: 1 0 0 0 0 1 0 0 0 0 1 0\nTr: 0 -1 0 0.1 0 0 -1 -0.2 1 0 0 -0.3\n");
  add(0, "calib_object", "R0_rect: 1 0 0 0 1 0 0 0 1\nTr_velo_to_cam: 0 -1 0 0.1 0 0 -1 -0.2 1 0 0 -0.3\n");
  add(1, "calib_raw", "calib_time: 15-Mar-2012 11:37:16\nR: " + rotation + "\nT: -0.8 0.3 -0.8\n");
  std::string record = "49.015 8.434 116.4";
  for (int i = 3; i < 30; ++i) record += " 0.01";
  add(2, "oxts", record + "\n" + record + "\n");
  add(3, "times", "0.000000e+00\n1.037359e-01\n2.074719e-01\n");
  add(3, "timestamps", "2011-09-26 13:02:25.594360375\n2011-09-26 13:02:25.697700000\n");
  add(4, "labels", bytesOf(std::uint32_t{40}) + bytesOf(std::uint32_t{0x10032}) + bytesOf(std::uint32_t{252}));

  std::vector<StampedPose> poses;
  for (int i = 0; i < 5; ++i) {
    StampedPose pose;
    pose.stamp_s = 0.5 * i;
    pose.T_map_body = Eigen::Translation3d(i, 0.1 * i, 0) * Eigen::AngleAxisd(0.1 * i, Eigen::Vector3d::UnitZ());
    poses.push_back(pose);
  }
  std::vector<Eigen::Isometry3d> matrices;
  for (const StampedPose& pose : poses) matrices.push_back(pose.T_map_body);
  writeTumTrajectory(seeds.fileFor("trajectory", "tum"), poses);
  writeKittiTrajectory(seeds.fileFor("trajectory", "kitti"), matrices);
  seeds.add("trajectory", "csv",
            "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],"
            "q_RS_z []\n1403636580838555648,4.6,-1.7,0.7,1,0,0,0\n"
            "1403636580938555648,4.7,-1.7,0.7,0.8,0.6,0,0\n");
  seeds.add("trajectory", "odometry",
            "stamp_s,x_m,y_m,z_m,qx,qy,qz,qw,sigma_m,sigma_deg\n0,0,0,0,0,0,0,1,0.1,0.2\n"
            "1,1,0,0,0,0,0,1,0.1,0.2\n2,2,0,0,0,0,0,1,0.1,0.2\n");
  seeds.add("trajectory", "positions",
            "stamp_s,x_m,y_m,z_m,sigma_x_m,sigma_y_m,sigma_z_m\n0,1,2,3,0.1,0.1,0.3\n"
            "0.5,2,3,4,0.1,0.1,0.3\n");
}

void writeDescriptions(const SeedFolder& seeds) {
  for (const auto& [fuzzer, folder] : {std::pair{"sensor_model", "sensors"}, std::pair{"scene", "scenes"}}) {
    for (const auto& entry : fs::directory_iterator(fs::path(SAW_NDT_SOURCE_DIR) / "data" / folder)) {
      fs::copy_file(entry.path(), seeds.fileFor(fuzzer, entry.path().filename()), fs::copy_options::overwrite_existing);
    }
  }
  MapOrigin origin;
  origin.software_version = "0.1.0";
  seeds.add("map_metadata", "unlabelled", internal::metadataText(origin));
  origin.labelled = true;
  origin.map_origin_m = {5000, 1e5, 0.1};
  origin.segmentation = SegmentationOptions();
  origin.segmentation->vehicle_box_m = {-1, -1, -1, 1, 1, 1};
  seeds.add("map_metadata", "labelled", internal::metadataText(origin));
  seeds.add("tile_metadata", "tiles",
            "x_resolution: 20.0\ny_resolution: 20.0\nA.pcd: [1200, 2500]\nB.pcd: [1220, 2500]\n");
  seeds.add("velodyne_calibration", "db", calibrationText(64));
  seeds.add("polygon", "names", "x_m,y_m\n0,0\n10,0\n10,5.5\n0,0\n");
  seeds.add("polygon", "blanks", "# a triangle\n0 0\n\n10 0\n10 5\n");
  seeds.add("config", "all", "# options\nlength = 2.5\ncount = 3\nnumbers = 1,2\nflag = true\nword = two\n");
}

}  // namespace

void writeFileSeeds(const SeedFolder& seeds) {
  writeScans(seeds);
  writeKitti(seeds);
  writeDescriptions(seeds);
}

}  // namespace saw_ndt
