#include "drives/prior_sources.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "common/pose_interpolation.h"
#include "io/csv_table.h"
#include "io/number_lines.h"
#include "io/rigid_transform.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/io/trajectory.h"

namespace saw_ndt {

using namespace internal;

namespace {

constexpr double kSameTime_s = 0.05;

// No odometry is better from scan to scan.
constexpr double kLeastSigma_m = 0.002;
constexpr double kLeastSigma_deg = 0.01;

template <typename Stamped>
void requireGrowingStamps(const std::filesystem::path& path, const std::vector<Stamped>& entries) {
  for (std::size_t i = 1; i < entries.size(); ++i) {
    if (entries[i].stamp_s > entries[i - 1].stamp_s) continue;
    throw Error(path.string(), "entry " + std::to_string(i + 1),
                "the stamp " + std::to_string(entries[i].stamp_s) + " is not after the one before");
  }
}

// Passes scans on with priors added.
class PriorSource : public ScanSource {
 public:
  explicit PriorSource(std::unique_ptr<ScanSource> scans) : scans_(std::move(scans)) {}

  bool next(RecordedScan& scan) override {
    if (!scans_->next(scan)) return false;
    addTo(scan);
    return true;
  }
  std::optional<std::size_t> scanCount() const override { return scans_->scanCount(); }

 private:
  virtual void addTo(RecordedScan& scan) = 0;

  std::unique_ptr<ScanSource> scans_;
};

// A pose of odometry, and the standard deviations of all the way to it.
struct OdometryPose {
  double stamp_s = 0.0;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  double sigma_m = 0.0;
  double sigma_deg = 0.0;
};

std::vector<OdometryPose> readOdometry(const std::filesystem::path& path, const OdometryDrift& drift) {
  std::vector<OdometryPose> poses;
  const std::vector<TextLine> lines = readAllLines(path);
  const bool is_csv = isCsv(lines);
  if (is_csv) {
    for (const NumberLine& line : csvNumberLines(csvTable(path, lines), {10})) {
      std::array<double, 8> values{};
      std::copy_n(line.values.begin(), values.size(), values.begin());
      const StampedPose pose = stampedPose(path, line.number, values);
      if (line.values[8] < 0.0 || line.values[9] < 0.0) {
        throw Error(path.string(), linePlace(line.number), "sigmas of 0 or more are needed");
      }
      poses.push_back({pose.stamp_s, pose.T_map_body, line.values[8], line.values[9]});
    }
  } else {
    for (const StampedPose& pose : readTumTrajectory(path)) poses.push_back({pose.stamp_s, pose.T_map_body});
  }
  requireGrowingStamps(path, poses);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    if (!is_csv) {
      poses[i].sigma_m = drift.share * (poses[i].T.translation() - poses[i - 1].T.translation()).norm();
      poses[i].sigma_deg = drift.deg_per_s * (poses[i].stamp_s - poses[i - 1].stamp_s);
    }
    poses[i].sigma_m += poses[i - 1].sigma_m;
    poses[i].sigma_deg += poses[i - 1].sigma_deg;
  }
  return poses;
}

class OdometrySource : public PriorSource {
 public:
  OdometrySource(std::unique_ptr<ScanSource> scans, std::vector<OdometryPose> poses)
      : PriorSource(std::move(scans)), poses_(std::move(poses)) {}

 private:
  void addTo(RecordedScan& scan) override {
    const std::optional<OdometryPose> now = at(scan.stamp_s);
    scan.priors.motion.reset();
    if (before_ && now) {
      const double sigma_m = std::max(kLeastSigma_m, std::abs(now->sigma_m - before_->sigma_m));
      const double sigma_rad =
          radiansFromDegrees(std::max(kLeastSigma_deg, std::abs(now->sigma_deg - before_->sigma_deg)));
      MeasuredMotion& motion = scan.priors.motion.emplace();
      motion.T_before_now = before_->T.inverse() * now->T;
      motion.covariance.diagonal() << Eigen::Vector3d::Constant(sigma_m * sigma_m),
          Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
    }
    before_ = now;
  }

  std::optional<OdometryPose> at(double stamp_s) const {
    const auto after = std::lower_bound(poses_.begin(), poses_.end(), stamp_s,
                                        [](const OdometryPose& pose, double stamp) { return pose.stamp_s < stamp; });
    if (after == poses_.end()) return std::nullopt;
    if (after->stamp_s == stamp_s) return *after;
    if (after == poses_.begin()) return std::nullopt;
    const OdometryPose& a = *(after - 1);
    const OdometryPose& b = *after;
    const double interval_s = b.stamp_s - a.stamp_s;
    if (interval_s > kLongestPoseGap_s) return std::nullopt;
    const double share = (stamp_s - a.stamp_s) / interval_s;
    OdometryPose pose;
    pose.stamp_s = stamp_s;
    pose.T = interpolatedPose(a.T, b.T, share);
    pose.sigma_m = a.sigma_m + share * (b.sigma_m - a.sigma_m);
    pose.sigma_deg = a.sigma_deg + share * (b.sigma_deg - a.sigma_deg);
    return pose;
  }

  std::vector<OdometryPose> poses_;
  std::optional<OdometryPose> before_;
};

struct StampedPosition {
  double stamp_s = 0.0;
  MeasuredPosition position;
};

std::vector<StampedPosition> readPositions(const std::filesystem::path& path, double sigma_m) {
  std::vector<StampedPosition> positions;
  const auto add = [&](double stamp_s, const Eigen::Vector3d& position_m, const Eigen::Vector3d& sigmas_m) {
    StampedPosition& added = positions.emplace_back();
    added.stamp_s = stamp_s;
    added.position.position_m = position_m;
    added.position.covariance = sigmas_m.cwiseAbs2().asDiagonal();
  };
  const Eigen::Vector3d default_m = Eigen::Vector3d::Constant(sigma_m);
  const std::vector<TextLine> lines = readAllLines(path);
  if (!isCsv(lines)) {
    for (const StampedPose& pose : readTumTrajectory(path)) {
      add(pose.stamp_s, pose.T_map_body.translation(), default_m);
    }
  } else {
    for (const NumberLine& line : csvNumberLines(csvTable(path, lines), {4, 7})) {
      const std::vector<double>& v = line.values;
      const Eigen::Vector3d sigmas_m = v.size() == 7 ? Eigen::Vector3d(v[4], v[5], v[6]) : default_m;
      if (!(sigmas_m.array() > 0.0).all()) {
        throw Error(path.string(), linePlace(line.number), "sigmas greater than 0 are needed");
      }
      add(v[0], {v[1], v[2], v[3]}, sigmas_m);
    }
  }
  requireGrowingStamps(path, positions);
  return positions;
}

class PositionSource : public PriorSource {
 public:
  PositionSource(std::unique_ptr<ScanSource> scans, std::vector<StampedPosition> positions)
      : PriorSource(std::move(scans)), positions_(std::move(positions)) {}

 private:
  void addTo(RecordedScan& scan) override {
    scan.priors.position.reset();
    const auto away_s = [&](const StampedPosition& position) { return std::abs(position.stamp_s - scan.stamp_s); };
    const auto after =
        std::lower_bound(positions_.begin(), positions_.end(), scan.stamp_s,
                         [](const StampedPosition& position, double stamp) { return position.stamp_s < stamp; });
    auto nearest = after;
    if (after == positions_.end() || (after != positions_.begin() && away_s(*(after - 1)) < away_s(*after))) --nearest;
    if (away_s(*nearest) <= kSameTime_s) scan.priors.position = nearest->position;
  }

  std::vector<StampedPosition> positions_;
};

}  // namespace

void OdometryDrift::check() const {
  checkOption(share >= 0.0 && std::isfinite(share), "share", share, "0 or more");
  checkOption(deg_per_s >= 0.0 && std::isfinite(deg_per_s), "deg_per_s", deg_per_s, "0 or more");
}

std::unique_ptr<ScanSource> withOdometry(std::unique_ptr<ScanSource> scans, const std::filesystem::path& path,
                                         const OdometryDrift& drift) {
  drift.check();
  return std::make_unique<OdometrySource>(std::move(scans), readOdometry(path, drift));
}

std::unique_ptr<ScanSource> withPositions(std::unique_ptr<ScanSource> scans, const std::filesystem::path& path,
                                          double sigma_m) {
  checkOption(sigma_m > 0.0 && std::isfinite(sigma_m), "sigma_m", sigma_m, "positive");
  return std::make_unique<PositionSource>(std::move(scans), readPositions(path, sigma_m));
}

}  // namespace saw_ndt
