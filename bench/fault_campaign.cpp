#include "fault_campaign.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "saw_ndt/common/geometry.h"
#include "scan_faults.h"

namespace saw_ndt {
namespace {

using Apply = decltype(Fault::apply);
using AlterScan = void (*)(std::vector<LidarPoint>&);

constexpr std::size_t kFaultyScans = 30;     // of a fault that lasts for a while
constexpr std::size_t kScansFromFault = 20;  // from one single faulty scan to the next
constexpr double kLeastJump_m = 30.0, kGreatestJump_m = 200.0;

std::string text(double value, const char* unit) {
  std::ostringstream stream;
  stream << value << unit;
  return stream.str();
}

/// Numbers of the scans that a fault of single scans meets, each among good ones; there is one after each of them.
std::vector<std::size_t> singleScans(const CampaignRun& run) {
  std::vector<std::size_t> numbers;
  for (std::size_t i = run.fault_begin; i + 1 < run.scans.size(); i += kScansFromFault) numbers.push_back(i);
  return numbers;
}

/// All scans count, for there is no fault, or it is in the drive or the map.
void none(CampaignRun& run, const LoadedDrive&, SceneRandom&) { run.fault_begin = 0; }

/// The initial pose is this far off in any direction, and turned by this angle to either side.
Apply wrongStart(double distance_m, double angle_deg) {
  return [=](CampaignRun& run, const LoadedDrive&, SceneRandom& random) {
    const double direction = random.uniform(-kPi, kPi);
    const double angle = radiansFromDegrees(angle_deg) * (random.chance(0.5) ? 1.0 : -1.0);
    Eigen::Isometry3d& T = *run.T_map_base_initial;
    T.translation() += distance_m * Eigen::Vector3d(std::cos(direction), std::sin(direction), 0.0);
    T.linear() = (Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()) * T.linear()).eval();
  };
}

/// Nobody knows where the vehicle is.
void unknownStart(CampaignRun& run, const LoadedDrive&, SceneRandom&) { run.T_map_base_initial.reset(); }

/// Odometry that drifts by a share of the way and so many degrees a second.
Apply withOdometry(Apply fault, double share, double deg_per_s) {
  return [=](CampaignRun& run, const LoadedDrive& drive, SceneRandom& random) {
    if (fault) fault(run, drive, random);
    const double side = random.chance(0.5) ? 1.0 : -1.0;
    for (std::size_t i = 1; i < run.scans.size(); ++i) {
      const double duration_s = run.scans[i].stamp_s - run.scans[i - 1].stamp_s;
      MeasuredMotion& motion = run.scans[i].priors.motion.emplace();
      motion.T_before_now = run.scans[i - 1].T_map_lidar.inverse() * run.scans[i].T_map_lidar;
      const double sigma_m = share * motion.T_before_now.translation().norm() + 1e-3;
      const double sigma_rad = radiansFromDegrees(deg_per_s * duration_s) + 1e-5;
      motion.T_before_now.translation() *= 1.0 + side * share;
      motion.T_before_now.linear() =
          (motion.T_before_now.linear() * rotationFromVector({0.0, 0.0, side * sigma_rad})).eval();
      motion.covariance.diagonal() << Eigen::Vector3d::Constant(sigma_m * sigma_m),
          Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
    }
  };
}

/// About normally distributed, of variance 1.
Eigen::Vector3d normalVector(SceneRandom& random) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i = 0; i < 12; ++i) {
    for (int axis = 0; axis < 3; ++axis) sum[axis] += random.uniform(-0.5, 0.5);
  }
  return sum;
}

/// Positions by GNSS, one in ten of which is 30 m off.
Apply withPositions(Apply fault, double sigma_m) {
  return [=](CampaignRun& run, const LoadedDrive& drive, SceneRandom& random) {
    if (fault) fault(run, drive, random);
    constexpr double kOutliers = 0.1, kOutlier_m = 30.0;
    for (PlayedScan& scan : run.scans) {
      MeasuredPosition& position = scan.priors.position.emplace();
      const double direction = random.uniform(-kPi, kPi);
      const double outlier_m = random.chance(kOutliers) ? kOutlier_m : 0.0;
      position.position_m = scan.T_map_lidar.translation() +
                            outlier_m * Eigen::Vector3d(std::cos(direction), std::sin(direction), 0.0) +
                            sigma_m * normalVector(random);
      position.covariance.diagonal().setConstant(sigma_m * sigma_m);
    }
  };
}

/// The vehicle is somewhere else along the way from one scan to the next; the stamps go on as if nothing had been.
void kidnap(CampaignRun& run, const LoadedDrive& drive, SceneRandom& random) {
  const std::size_t from = run.scans[run.fault_begin].recorded, rest = run.scans.size() - run.fault_begin;
  std::vector<std::size_t> places;
  for (std::size_t to = 0; to < drive.scans.size(); ++to) {
    const double jump_m = (drive.T_map_lidar[to].translation() - drive.T_map_lidar[from].translation()).norm();
    const bool in_reach = jump_m >= kLeastJump_m && jump_m <= kGreatestJump_m;
    if (in_reach && to + std::min(rest, kFaultyScans) <= drive.scans.size()) places.push_back(to);
  }
  if (places.empty()) return;
  const std::size_t to = places[random.index(places.size())];
  run.scans.resize(run.fault_begin + std::min(rest, drive.scans.size() - to));
  for (std::size_t i = run.fault_begin; i < run.scans.size(); ++i) {
    run.scans[i].recorded = to + i - run.fault_begin;
    run.scans[i].T_map_lidar = drive.T_map_lidar[run.scans[i].recorded];
  }
}

void alterForAWhile(CampaignRun& run, const std::function<void(std::vector<LidarPoint>&, std::size_t)>& alter) {
  for (std::size_t i = run.fault_begin; i < std::min(run.scans.size(), run.fault_begin + kFaultyScans); ++i) {
    run.scans[i].alter = [alter, i](std::vector<LidarPoint>& points) { alter(points, i); };
  }
  run.fault_end = run.fault_begin + kFaultyScans;
}

Apply blockedView(double share) {
  return [=](CampaignRun& run, const LoadedDrive&, SceneRandom& random) {
    const double start = random.uniform(-kPi, kPi);
    alterForAWhile(run, [=](std::vector<LidarPoint>& points, std::size_t) { blockSector(points, start, share); });
  };
}

Apply rain(void (*of_scan)(std::vector<LidarPoint>&, double, std::uint64_t), double share) {
  return [=](CampaignRun& run, const LoadedDrive&, SceneRandom& random) {
    const std::uint64_t seed = random.index(1u << 30);
    alterForAWhile(
        run, [=](std::vector<LidarPoint>& points, std::size_t scan) { of_scan(points, share, mixedSeed(seed, scan)); });
  };
}

/// Scans are missing for so long; the stamps are true.
Apply drop(double seconds) {
  return [=](CampaignRun& run, const LoadedDrive& drive, SceneRandom&) {
    const std::size_t first = run.scans.front().recorded, count = run.scans.size();
    const double end_s = run.scans[run.fault_begin].stamp_s + seconds;
    run.scans.resize(run.fault_begin);
    for (PlayedScan& scan : CampaignRun::recorded(drive, first + run.fault_begin, drive.scans.size()).scans) {
      if (scan.stamp_s >= end_s - 1e-6 && run.scans.size() < count) run.scans.push_back(std::move(scan));
    }
  };
}

/// A scan comes once more with the same stamp.
void repeatStamped(CampaignRun& run, const LoadedDrive&, SceneRandom&) {
  std::vector<std::size_t> numbers = singleScans(run);
  std::reverse(numbers.begin(), numbers.end());
  for (const std::size_t i : numbers) {
    const PlayedScan scan = run.scans[i];
    run.scans.insert(run.scans.begin() + static_cast<std::ptrdiff_t>(i), scan);
  }
}

/// A scan comes once more in place of the next one, with that one's stamp.
void repeatAsNext(CampaignRun& run, const LoadedDrive&, SceneRandom&) {
  for (const std::size_t i : singleScans(run)) {
    run.scans[i + 1].recorded = run.scans[i].recorded;
    run.scans[i + 1].T_map_lidar = run.scans[i].T_map_lidar;
  }
}

/// Two scans come in the wrong order, each with its own stamp or with those that one would expect.
Apply swapScans(bool sorted_stamps) {
  return [=](CampaignRun& run, const LoadedDrive&, SceneRandom&) {
    for (const std::size_t i : singleScans(run)) {
      std::swap(run.scans[i], run.scans[i + 1]);
      if (sorted_stamps) std::swap(run.scans[i].stamp_s, run.scans[i + 1].stamp_s);
    }
  };
}

Apply jumpOfStamps(double seconds, bool once) {
  return [=](CampaignRun& run, const LoadedDrive&, SceneRandom&) {
    const std::size_t end = once ? run.fault_begin + 1 : run.scans.size();
    for (std::size_t i = run.fault_begin; i < std::min(end, run.scans.size()); ++i) run.scans[i].stamp_s += seconds;
  };
}

/// Single scans have points that say nothing, or next to nothing.
Apply badScans(AlterScan alter, bool shows_nothing) {
  return [=](CampaignRun& run, const LoadedDrive&, SceneRandom&) {
    for (const std::size_t i : singleScans(run)) {
      run.scans[i].alter = alter;
      run.scans[i].shows_nothing = shows_nothing;
    }
  };
}

/// The sensor sits otherwise from some scan on; the truth is where it really is.
Apply movedSensor(double roll_deg, double pitch_deg, const Eigen::Vector3d& shift_m) {
  Vector6d xyz_rpy;
  xyz_rpy << shift_m, radiansFromDegrees(roll_deg), radiansFromDegrees(pitch_deg), 0.0;
  return [T_old_new = transformFromXyzRpy(xyz_rpy)](CampaignRun& run, const LoadedDrive&, SceneRandom&) {
    for (std::size_t i = run.fault_begin; i < run.scans.size(); ++i) {
      run.scans[i].alter = [T_old_new](std::vector<LidarPoint>& points) { moveSensor(points, T_old_new); };
      run.scans[i].T_map_lidar = run.scans[i].T_map_lidar * T_old_new;
    }
  };
}

/// The drive itself has the fault: only where it begins is to be said.
void braking(CampaignRun& run, const LoadedDrive&, SceneRandom&) {
  const auto driving = [](const PlayedScan& scan) { return scan.stamp_s < kBrakingStart_s; };
  run.fault_begin = static_cast<std::size_t>(std::count_if(run.scans.begin(), run.scans.end(), driving));
}

/// The map has the fault.
void otherPlace(CampaignRun& run, const LoadedDrive&, SceneRandom&) { run.place_in_map = false; }
void otherPlaceUnknown(CampaignRun& run, const LoadedDrive&, SceneRandom&) {
  run.place_in_map = false;
  run.T_map_base_initial.reset();
}

std::vector<Fault> makeFaults() {
  std::vector<Fault> faults;
  const auto add = [&faults](const char* kind, const std::string& strength, Apply apply,
                             CampaignDrive drive = CampaignDrive::TEST, CampaignMap map = CampaignMap::OWN) {
    faults.push_back({kind, strength, false, drive, map, std::move(apply)});
  };
  const auto addFromStart = [&faults](const char* kind, const std::string& strength, Apply apply,
                                      CampaignMap map = CampaignMap::OWN) {
    faults.push_back({kind, strength, true, CampaignDrive::TEST, map, std::move(apply)});
  };
  add("none", "", none);
  addFromStart("start_on_the_way", "", {});
  for (const double m : {1, 2, 5, 10, 20, 50}) addFromStart("wrong_start", text(m, " m"), wrongStart(m, 0.0));
  for (const double deg : {5, 10, 20, 45, 90, 180})
    addFromStart("wrong_heading", text(deg, " deg"), wrongStart(0.0, deg));
  for (const auto& [m, deg] : {std::pair(1.0, 5.0), {2.0, 10.0}, {5.0, 20.0}, {10.0, 45.0}, {50.0, 180.0}}) {
    addFromStart("wrong_start_and_heading", text(m, " m, ") + text(deg, " deg"), wrongStart(m, deg));
  }
  addFromStart("unknown_start", "", unknownStart);
  addFromStart("unknown_start_with_gnss", "", withPositions(unknownStart, 2.0));
  add("kidnapping", "", kidnap);
  add("kidnapping_with_gnss", "", withPositions(kidnap, 2.0));
  for (const double percent : {20, 50, 90}) add("blocked_view", text(percent, " %"), blockedView(percent / 100.0));
  for (const double percent : {5, 20, 50}) add("rain", text(percent, " % near"), rain(rainOn, percent / 100.0));
  for (const double percent : {50, 90}) add("rain", text(percent, " % lost"), rain(loseReturns, percent / 100.0));
  add("dense_traffic", "", none, CampaignDrive::DENSE_TRAFFIC);
  for (const double s : {0.5, 1.0, 2.0, 5.0, 10.0}) add("dropped_scans", text(s, " s"), drop(s));
  for (const double s : {2.0, 5.0, 10.0}) {
    add("dropped_scans_with_odometry", text(s, " s"), withOdometry(drop(s), 0.02, 0.5));
    add("dropped_scans_with_gnss", text(s, " s"), withPositions(drop(s), 2.0));
  }
  add("repeated_scans", "same stamp", repeatStamped);
  add("repeated_scans", "next stamp", repeatAsNext);
  add("swapped_scans", "own stamps", swapScans(false));
  add("swapped_scans", "sorted stamps", swapScans(true));
  for (const double s : {1.0, -1.0, 3600.0}) {
    add("stamp_jump", text(s, " s, one scan"), jumpOfStamps(s, true));
    add("stamp_jump", text(s, " s, from then on"), jumpOfStamps(s, false));
  }
  add("zeros", "", badScans(makeZeros, true));
  add("one_point", "", badScans(makeOnePoint, true));
  add("few_points", "", badScans(makeFewPoints, false));
  add("empty", "", badScans(makeEmpty, true));
  add("not_a_number", "", badScans(makeNotANumber, true));
  add("braking", "", braking, CampaignDrive::BRAKING);
  for (const double deg : {1.0, 3.0}) {
    add("moved_sensor", text(deg, " deg roll"), movedSensor(deg, 0.0, Eigen::Vector3d::Zero()));
    add("moved_sensor", text(deg, " deg pitch"), movedSensor(0.0, deg, Eigen::Vector3d::Zero()));
  }
  add("moved_sensor", "0.2 m ahead", movedSensor(0.0, 0.0, {0.2, 0.0, 0.0}));
  add("moved_sensor", "0.2 m left", movedSensor(0.0, 0.0, {0.0, 0.2, 0.0}));
  add("moved_sensor", "0.2 m up", movedSensor(0.0, 0.0, {0.0, 0.0, 0.2}));
  addFromStart("other_place", "", otherPlace, CampaignMap::OF_OTHER_SCENE);
  addFromStart("other_place", "unknown start", otherPlaceUnknown, CampaignMap::OF_OTHER_SCENE);
  add("changed_place", "", none, CampaignDrive::TEST, CampaignMap::CHANGED);
  return faults;
}

}  // namespace

const std::vector<Fault>& allFaults() {
  static const std::vector<Fault> faults = makeFaults();
  return faults;
}

std::vector<std::string> faultKinds() {
  std::vector<std::string> kinds;
  for (const Fault& fault : allFaults()) {
    if (kinds.empty() || kinds.back() != fault.kind) kinds.push_back(fault.kind);
  }
  return kinds;
}

}  // namespace saw_ndt
