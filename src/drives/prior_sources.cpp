#include "drives/prior_sources.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "common/pose_interpolation.h"
#include "io/number_lines.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/io/trajectory.h"

namespace saw_ndt {

using namespace internal;

namespace {

constexpr double kLongestGap_s = 1.0;
constexpr double kSameTime_s = 0.05;

// No odometry is better from scan to scan.
constexpr double kLeastSigma_m = 0.002;
constexpr double kLeastSigma_deg = 0.01;

bool isCsv(const std::vector<TextLine>& lines) {
  return !lines.empty() && lines.front().text.find(',') != std::string::npos;
}

// The lines of a CSV file of numbers without its names.
std::vector<NumberLine> readCsvLines(const std::filesystem::path& path, const std::vector<std::size_t>& columns) {
  std::vector<NumberLine> lines;
  std::vector<TextLine> texts = readTextLines(path);
  const std::size_t letter = texts.front().text.find_first_not_of(" \t\"");
  if (letter != std::string::npos && std::isalpha(static_cast<unsigned char>(texts.front().text[letter])) != 0) {
    texts.erase(texts.begin());
  }
  for (TextLine& line : texts) {
    std::replace(line.text.begin(), line.text.end(), ',', ' ');
    NumberLine numbers{line.number, parseNumbers(path, line.number, line.text)};
    const std::size_t count = numbers.values.size();
    if (std::find(columns.begin(), columns.end(), count) == columns.end()) {
      std::string wanted = std::to_string(columns.front());
      for (std::size_t i = 1; i < columns.size(); ++i) wanted += " or " + std::to_string(columns[i]);
      throw Error(path.string(), linePlace(line.number),
                  std::to_string(count) + " numbers, where " + wanted + " are needed");
    }
    lines.push_back(std::move(numbers));
  }
  if (lines.empty()) throw Error(path.string(), "", "holds no line of numbers");
  return lines;
}

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
  const bool is_csv = isCsv(readTextLines(path));
  const std::vector<StampedPose> trajectory = is_csv ? std::vector<StampedPose>() : readTumTrajectory(path);
  for (const StampedPose& pose : trajectory) poses.push_back({pose.stamp_s, pose.T_map_body});
  for (const NumberLine& line : is_csv ? readCsvLines(path, {10}) : std::vector<NumberLine>()) {
    const std::vector<double>& v = line.values;
    OdometryPose& pose = poses.emplace_back();
    pose.stamp_s = v[0];
    pose.T.translation() << v[1], v[2], v[3];
    const Eigen::Quaterniond q(v[7], v[4], v[5], v[6]);
    constexpr double kNormTolerance = 1e-3;
    if (std::abs(q.norm() - 1.0) > kNormTolerance || v[8] < 0.0 || v[9] < 0.0) {
      throw Error(path.string(), linePlace(line.number), "a quaternion of norm 1 and sigmas of 0 or more are needed");
    }
    pose.T.linear() = q.normalized().toRotationMatrix();
    pose.sigma_m = v[8];
    pose.sigma_deg = v[9];
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
    if (interval_s > kLongestGap_s) return std::nullopt;
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
  if (!isCsv(readTextLines(path))) {
    for (const StampedPose& pose : readTumTrajectory(path)) {
      add(pose.stamp_s, pose.T_map_body.translation(), default_m);
    }
  } else {
    for (const NumberLine& line : readCsvLines(path, {4, 7})) {
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
