#include <iostream>

#include "app_options.h"
#include "io/staged_output.h"
#include "output_folder.h"
#include "progress_bar.h"
#include "report/sensor_model_file.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/io/trajectory.h"
#include "scene_files.h"
#include "simulation/lidar_simulator.h"
#include "simulation/reference_noise.h"
#include "simulation/sequence_writer.h"
#include "simulation/simulated_drive.h"

namespace {

constexpr char kDescription[] =
    "Drives a LiDAR through a scene and writes what it sees as a sequence in KITTI odometry layout: velodyne/*.bin, "
    "labels/*.label (SemanticKITTI classes), calib.txt, times.txt and poses.txt, whose poses are exact. Drives of one "
    "scene (same -scene, -trajectory and -seed) share the map frame and all that stands; -drive 2 and on differ from "
    "drive 1 in traffic, parked cars and the way within the lane, so that a map need not be built from the scans that "
    "are localized in it. The same options give the same bytes.";

/// Poses of the LiDAR and their stamps from a trajectory file; those of KITTI format are a camera's.
void readRecorded(const std::string& file, const std::string& times_file, double scan_period_s,
                  std::vector<Eigen::Isometry3d>& T_scene_lidar, std::vector<double>& stamps_s) {
  const saw_ndt::Trajectory trajectory = saw_ndt::readTrajectory(file);
  const bool of_camera = trajectory.format == saw_ndt::TrajectoryFormat::KITTI;
  for (const saw_ndt::StampedPose& pose : trajectory.poses) {
    T_scene_lidar.push_back(of_camera ? saw_ndt::lidarPose(pose.T_map_body, saw_ndt::simulatedCalibration())
                                      : pose.T_map_body);
    stamps_s.push_back(of_camera ? scan_period_s * static_cast<double>(stamps_s.size()) : pose.stamp_s);
  }
  if (times_file.empty()) return;
  stamps_s = saw_ndt::readStamps(times_file);
  if (stamps_s.size() != T_scene_lidar.size()) {
    throw saw_ndt::Error(times_file, "",
                         std::to_string(stamps_s.size()) + " stamps for the " + std::to_string(T_scene_lidar.size()) +
                             " poses of " + file);
  }
}

std::string sensorHelp() {
  std::string help = "the LiDAR:";
  for (const std::string& name : saw_ndt::SensorModel::names()) {
    if (saw_ndt::SensorModel::named(name).rows() > 0) help += " " + name + ",";
  }
  return help + " or FILE.json, another one as in data/sensors";
}

}  // namespace

int main(int argc, char** argv) {
  std::string out_dir, scene = "residential", trajectory, times, sensor = saw_ndt::LidarOptions().sensor.name;
  int seed = 1, scans = 0;
  bool rolling_shutter = false;
  saw_ndt::DriveOptions drive_options;
  double rain_share = 0.0, reference_noise_m = 0.0, mounting_roll_deg = 0.0, mounting_pitch_deg = 0.0;
  saw_ndt::AppOptions app("saw_ndt_simulate", kDescription);
  app.addPositional("OUT_DIR", &out_dir, "folder for the sequence, made where it is missing");
  app.addOption("scene", &scene, "NAME",
                "residential, highway, rural, tunnel, bridge, plain or equal_houses, or the file of another scene");
  app.addOption("drive", &drive_options.drive, "N", "which drive through the scene, 1 or more");
  app.addOption("seed", &seed, "N", "of the scene and of all its drives");
  app.addOption("scans", &scans, "N", "scans at most; 0: to the end of the course or trajectory");
  app.addOption(
      "trajectory", &trajectory, "FILE",
      "drive these poses (KITTI: of the camera; TUM and CSV: of the LiDAR) in x, y and heading, the scene laid along "
      "them; height and inclination are the ground's");
  app.addOption("times", &times, "FILE", "stamps of the poses of a KITTI trajectory (default: a turn of the LiDAR)");
  app.addOption("sensor", &sensor, "NAME", sensorHelp());
  app.addOption("mount-roll", &mounting_roll_deg, "DEGREES",
                "how far the LiDAR is rolled on the vehicle, its left side up; 180: it hangs upside down");
  app.addOption("mount-pitch", &mounting_pitch_deg, "DEGREES",
                "angle by which the LiDAR's x axis points below the vehicle's");
  app.addFlag("rolling-shutter", &rolling_shutter,
              "leave the motion during a turn in the scans; otherwise each is seen from its pose");
  app.addOption("rain", &rain_share, "SHARE", "share of the rays that meet a droplet, 0 to 1");
  app.addOption("objects", &drive_options.object_density, "SHARE",
                "share of the scene's objects that are there, 0 to 1");
  app.addOption("traffic", &drive_options.traffic_density, "FACTOR", "factor of the scene's traffic, 0 to 10");
  app.addOption("reference-noise", &reference_noise_m, "METRES",
                "slow error of a GNSS/INS on the poses, one sigma of x and y (z 1.5 times that, 0.3 degrees a metre); "
                "poses_true.txt then has the truth");

  return saw_ndt::runApp(argc, argv, app, [&] {
    if (!times.empty() && trajectory.empty()) throw saw_ndt::UsageError("option -times needs -trajectory");
    saw_ndt::LidarOptions lidar =
        saw_ndt::LidarOptions::of(saw_ndt::checkedUsage([&] { return saw_ndt::sensorModelOf(sensor); }));
    saw_ndt::ReferenceNoiseOptions noise;
    saw_ndt::checkedUsage([&] {
      saw_ndt::checkOption(seed >= 0, "seed", seed, "0 or greater");
      saw_ndt::checkOption(scans >= 0, "scans", scans, "0 or greater");
      drive_options.seed = static_cast<std::uint64_t>(seed);
      lidar.rolling_shutter = rolling_shutter;
      lidar.rain_share = rain_share;
      lidar.mounting_roll_deg = mounting_roll_deg;
      lidar.mounting_pitch_deg = mounting_pitch_deg;
      noise.position_sigma_m = reference_noise_m;
      // Each drive has noise of its own.
      noise.seed = lidar.seed = drive_options.seed * 1000003u + static_cast<std::uint64_t>(drive_options.drive);
      drive_options.check();
      lidar.check();
      noise.check();
    });
    const saw_ndt::SceneDescription description = saw_ndt::readSceneDescription(saw_ndt::sceneFile(scene));
    std::error_code ignored;
    if (std::filesystem::exists(std::filesystem::path(out_dir) / "velodyne", ignored)) {
      throw saw_ndt::Error(out_dir, "", "holds a sequence already; name another folder or remove it");
    }
    saw_ndt::OutputFolder folder(out_dir);

    saw_ndt::SimulatedDrive drive;
    if (trajectory.empty()) {
      drive = saw_ndt::driveCourse(description, drive_options, lidar.scan_period_s, scans);
    } else {
      std::vector<Eigen::Isometry3d> T_scene_lidar;
      std::vector<double> stamps_s;
      readRecorded(trajectory, times, lidar.scan_period_s, T_scene_lidar, stamps_s);
      drive = saw_ndt::driveTrajectory(description, drive_options, T_scene_lidar, stamps_s, scans);
    }
    saw_ndt::LidarSimulator simulator(drive.scene, lidar, app.threads());
    const saw_ndt::VehicleMotion motion = drive.motion->withMounting(lidar.R_vehicle_lidar());
    std::vector<Eigen::Isometry3d> reference;
    if (reference_noise_m > 0.0) reference = saw_ndt::withReferenceNoise(motion, noise);
    saw_ndt::internal::StagedOutput staged(folder.path());
    saw_ndt::ProgressBar progress(static_cast<std::size_t>(motion.scanCount()));
    const saw_ndt::SequenceContent content =
        saw_ndt::writeSequence(staged.folder(), simulator, motion, reference, [&] { progress.step(); });
    staged.commit();
    folder.keep();
    std::cout << out_dir << ": " << content.scan_count << " scans of " << description.name << ", drive "
              << drive_options.drive << ", " << content.point_count << " points\n";
  });
}
