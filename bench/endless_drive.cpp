#include "endless_drive.h"

#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"
#include "scan_faults.h"

namespace saw_ndt {
namespace {

constexpr int kMostDropped = 10;
constexpr int kLeastBlinded = 5, kMostBlinded = 40;  // scans: from some that are coasted over to a lost vehicle
constexpr double kBlindedShare = 0.98;               // of the full turn

}  // namespace

const char* toString(DriveFault fault) {
  switch (fault) {
    case DriveFault::NONE:
      return "none";
    case DriveFault::DROPPED:
      return "dropped";
    case DriveFault::EMPTY:
      return "empty";
    case DriveFault::NOT_A_NUMBER:
      return "not a number";
    case DriveFault::ZEROS:
      return "zeros";
    case DriveFault::REPEATED:
      return "repeated";
    case DriveFault::REPEATED_NEXT:
      return "repeated with the next stamp";
    case DriveFault::BLINDED:
      return "blinded";
    case DriveFault::KIDNAPPED:
      return "kidnapped";
  }
  return "";
}

EndlessDrive::EndlessDrive(const Recording& recording, std::size_t fault_scans, std::uint64_t seed)
    : recording_(recording), fault_scans_(fault_scans), random_(seed), period_s_(recording.scanPeriod()) {
  if (recording.scanCount() <= kMostDropped) throw Error(recording.path().string(), "", "has too few scans");
}

void EndlessDrive::read(int number) {
  number_ = number;
  recording_.readScan(number, scan_);
  const std::optional<Eigen::Isometry3d> T_map_lidar = recording_.referencePose(number);
  if (!T_map_lidar) throw Error(recording_.path().string(), recording_.scanName(number), "has no reference pose");
  T_map_lidar_ = *T_map_lidar;
}

void EndlessDrive::advance(int scans) {
  stamp_s_ += scans * period_s_;
  const bool ends = number_ + scans >= recording_.scanCount();
  if (ends) ++faults_[static_cast<std::size_t>(DriveFault::KIDNAPPED)];
  read(ends ? 0 : number_ + scans);
}

void EndlessDrive::begin(DriveFault fault) {
  ++faults_[static_cast<std::size_t>(fault)];
  switch (fault) {
    case DriveFault::DROPPED:
      return advance(1 + static_cast<int>(random_.index(kMostDropped)));
    case DriveFault::REPEATED:
      return;
    case DriveFault::REPEATED_NEXT:
      stamp_s_ += period_s_;
      return;
    case DriveFault::BLINDED:
      blinded_scans_ = kLeastBlinded + static_cast<int>(random_.index(kMostBlinded - kLeastBlinded));
      blinded_from_rad_ = random_.uniform(-kPi, kPi);
      break;
    case DriveFault::KIDNAPPED:
      stamp_s_ += period_s_;
      return read(static_cast<int>(random_.index(static_cast<std::size_t>(recording_.scanCount()))));
    case DriveFault::NONE:
    case DriveFault::EMPTY:
    case DriveFault::NOT_A_NUMBER:
    case DriveFault::ZEROS:
      break;
  }
  advance(1);
}

void EndlessDrive::next() {
  const bool faulty = fault_scans_ > 0 && number_ >= 0 && blinded_scans_ == 0 &&
                      random_.chance(1.0 / static_cast<double>(fault_scans_));
  const auto fault = static_cast<DriveFault>(faulty ? 1 + random_.index(kDriveFaults - 1) : 0);
  begin(fault);
  altered_ = scan_;
  if (fault == DriveFault::EMPTY) makeEmpty(altered_.points);
  if (fault == DriveFault::NOT_A_NUMBER) makeNotANumber(altered_.points);
  if (fault == DriveFault::ZEROS) makeZeros(altered_.points);
  if (blinded_scans_ > 0) {
    --blinded_scans_;
    blockSector(altered_.points, blinded_from_rad_, kBlindedShare);
  }
  if (altered_.points.size() == scan_.points.size()) return;
  // What belongs to the points that are left is not known any more.
  altered_.rings.clear();
  altered_.times_s.clear();
  altered_.height = 1;
}

}  // namespace saw_ndt
