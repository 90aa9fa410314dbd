#include "localization/motion_compensation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/no_return.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt::internal {
namespace {

// How long a scan may last (s).
constexpr double kShortestScan_s = 0.01;
constexpr double kLongestScan_s = 1.5;

// Times begin at 0 if the first one is nearer to it than this share of the scan.
constexpr double kStartShare = 0.2;

constexpr double kUsualPeriod_s = 0.1;

// Less is not worth a change of the points (m).
constexpr double kNegligibleShift_m = 0.01;

// The arc tangent of 0 to 1 by a polynomial that is off by 1e-5 rad at most.
inline float arcTangent(float ratio) {
  const float square = ratio * ratio;
  return ratio *
         (0.99997726F +
          square * (-0.33262347F +
                    square * (0.19354346F + square * (-0.11643287F + square * (0.05265332F - square * 0.01172120F)))));
}

inline float azimuth(float x, float y) {
  const float ax = std::abs(x), ay = std::abs(y);
  const float larger = std::max(std::max(ax, ay), std::numeric_limits<float>::min());
  const float within = arcTangent(std::min(ax, ay) / larger);
  const float quarter = ay > ax ? static_cast<float>(kPi / 2.0) - within : within;
  const float half = x < 0.0F ? static_cast<float>(kPi) - quarter : quarter;
  return y < 0.0F ? -half : half;
}

// Coordinates of points one after the other.
struct Columns {
  const float* x;
  const float* y;
  const float* z;
  const float* time_s;
};

// A motion in single precision, before and after the stamp.
struct Rates {
  explicit Rates(const ScanMotion& motion) {
    for (int k = 0; k < 3; ++k) {
      before[k] = static_cast<float>(motion.before.velocity_mps[k]);
      before[3 + k] = static_cast<float>(motion.before.turn_rate_radps[k]);
      after[k] = static_cast<float>(motion.after.velocity_mps[k]);
      after[3 + k] = static_cast<float>(motion.after.turn_rate_radps[k]);
    }
  }
  float before[6];
  float after[6];
};

void moveColumns(std::size_t count, const Columns& from, const ScanMotion& motion, float* __restrict to_x,
                 float* __restrict to_y, float* __restrict to_z) {
  const float* __restrict x = from.x;
  const float* __restrict y = from.y;
  const float* __restrict z = from.z;
  const float* __restrict times_s = from.time_s;
  const Rates rates(motion);
  const auto of = [&](int k, float t) { return t < 0.0F ? rates.before[k] : rates.after[k]; };
  for (std::size_t i = 0; i < count; ++i) {
    const float t = times_s[i], t2 = t * t;
    const float vx = of(0, t), vy = of(1, t), vz = of(2, t), wx = of(3, t), wy = of(4, t), wz = of(5, t);
    const float rate_squared = wx * wx + wy * wy + wz * wz;
    const float ux = vx + (wy * z[i] - wz * y[i]);
    const float uy = vy + (wz * x[i] - wx * z[i]);
    const float uz = vz + (wx * y[i] - wy * x[i]);
    const float ax = wy * uz - wz * uy, ay = wz * ux - wx * uz, az = wx * uy - wy * ux;
    const float bx = wy * az - wz * ay, by = wz * ax - wx * az, bz = wx * ay - wy * ax;
    const float angle_squared = rate_squared * t2;
    const float a = t2 * (0.5F - angle_squared * (1.0F / 24.0F - angle_squared * (1.0F / 720.0F)));
    const float b = t2 * t * (1.0F / 6.0F - angle_squared * (1.0F / 120.0F - angle_squared * (1.0F / 5040.0F)));
    to_x[i] = x[i] + (t * ux + (a * ax + b * bx));
    to_y[i] = y[i] + (t * uy + (a * ay + b * by));
    to_z[i] = z[i] + (t * uz + (a * az + b * bz));
  }
}

// @param row_x, row_y  of T_lidar_points: what x and y of the LiDAR's frame are
void azimuthTimes(std::size_t count, const Columns& points, const Eigen::Vector4f& row_x, const Eigen::Vector4f& row_y,
                  float signed_period_s, float* __restrict times_s) {
  const float* __restrict x = points.x;
  const float* __restrict y = points.y;
  const float* __restrict z = points.z;
  const float factor = signed_period_s / static_cast<float>(2.0 * kPi);
  const float x0 = row_x[0], x1 = row_x[1], x2 = row_x[2], x3 = row_x[3];
  const float y0 = row_y[0], y1 = row_y[1], y2 = row_y[2], y3 = row_y[3];
  for (std::size_t i = 0; i < count; ++i) {
    times_s[i] = factor * azimuth(x0 * x[i] + x1 * y[i] + x2 * z[i] + x3, y0 * x[i] + y1 * y[i] + y2 * z[i] + y3);
  }
}

double signedPeriod(MotionCompensation times, double period_s) {
  return times == MotionCompensation::FROM_AZIMUTH_CLOCKWISE ? -period_s : period_s;
}

}  // namespace

BodyMotion motionBetween(const Eigen::Isometry3d& T_before_now, double duration_s) {
  const Eigen::Vector3d turned = rotationVector(T_before_now.linear());
  return {meanRotation(turned).inverse() * T_before_now.translation() / duration_s, turned / duration_s};
}

double shiftBetween(const ScanMotion& a, const ScanMotion& b, double duration_s) {
  const auto speed = [](const BodyMotion& one, const BodyMotion& other) {
    return (one.velocity_mps - other.velocity_mps).norm() +
           kShiftArm_m * (one.turn_rate_radps - other.turn_rate_radps).norm();
  };
  return duration_s * std::max(speed(a.before, b.before), speed(a.after, b.after));
}

std::optional<ScanClock> clockOf(const ScanView& scan, double stamp_s) {
  if (!scan.times_s.known()) return std::nullopt;
  double first = std::numeric_limits<double>::infinity(), last = -first;
  for (std::size_t i = 0; i < scan.size; ++i) {
    const float* const point = scan.point(i);
    if (!isReturn(point) || !std::isfinite(point[0])) continue;
    const double time = scan.times_s[i];
    first = std::min(first, time);
    last = std::max(last, time);
  }
  ScanClock clock;
  const double span = last - first;
  for (const double unit_s : {1.0, 1e-3, 1e-6, 1e-9}) {
    clock.unit_s = unit_s;
    if (span * unit_s < kShortestScan_s || span * unit_s > kLongestScan_s) continue;
    const bool is_from_stamp = first <= kStartShare * span && last >= 0.0;
    if (is_from_stamp) return clock;
    const bool is_absolute = std::abs(first * unit_s - stamp_s) <= kLongestScan_s;
    clock.zero = is_absolute ? stamp_s / unit_s : first;
    return clock;
  }
  return std::nullopt;
}

void timesFromAzimuth(const SourcePoints& points, const Eigen::Isometry3d& T_base_lidar, bool counterclockwise,
                      double period_s, std::vector<float>& times_s) {
  times_s.resize(points.size());
  const Eigen::Matrix4f T_lidar_base = T_base_lidar.inverse().matrix().cast<float>();
  azimuthTimes(points.size(), {points.x.data(), points.y.data(), points.z.data(), nullptr}, T_lidar_base.row(0),
               T_lidar_base.row(1), static_cast<float>(counterclockwise ? period_s : -period_s), times_s.data());
}

void compensate(const SourcePoints& points, const std::vector<float>& times_s, const ScanMotion& motion,
                SourcePoints& moved) {
  moved.x.resize(points.size());
  moved.y.resize(points.size());
  moved.z.resize(points.size());
  moveColumns(points.size(), {points.x.data(), points.y.data(), points.z.data(), times_s.data()}, motion,
              moved.x.data(), moved.y.data(), moved.z.data());
}

bool compensateScan(const ScanView& scan, MotionCompensation times, const ScanTiming& timing, const ScanMotion& motion,
                    std::vector<LidarPoint>& moved) {
  constexpr std::size_t kBlock = 256;
  std::optional<ScanClock> clock;
  if (times == MotionCompensation::FROM_TIMES) clock = clockOf(scan, timing.stamp_s);
  const bool by_azimuth = times != MotionCompensation::FROM_TIMES && times != MotionCompensation::OFF;
  moved.resize(scan.size);
  alignas(64) float x[kBlock], y[kBlock], z[kBlock], time_s[kBlock];
  for (std::size_t begin = 0; begin < scan.size; begin += kBlock) {
    const std::size_t count = std::min(kBlock, scan.size - begin);
    for (std::size_t i = 0; i < count; ++i) {
      const float* const point = scan.point(begin + i);
      x[i] = point[0];
      y[i] = point[1];
      z[i] = point[2];
      time_s[i] = clock ? (*clock)(scan.times_s[begin + i]) : 0.0F;
    }
    if (by_azimuth) {
      azimuthTimes(count, {x, y, z, nullptr}, Eigen::Vector4f::UnitX(), Eigen::Vector4f::UnitY(),
                   static_cast<float>(signedPeriod(times, timing.period_s)), time_s);
    }
    for (std::size_t i = 0; i < count; ++i) {
      const bool is_timed = isReturn(scan.point(begin + i)) && std::isfinite(time_s[i]);
      time_s[i] = is_timed ? time_s[i] : 0.0F;
    }
    alignas(64) float moved_x[kBlock], moved_y[kBlock], moved_z[kBlock];
    moveColumns(count, {x, y, z, time_s}, motion, moved_x, moved_y, moved_z);
    for (std::size_t i = 0; i < count; ++i) moved[begin + i] = {moved_x[i], moved_y[i], moved_z[i], 0.0F};
  }
  return by_azimuth || clock.has_value();
}

void ScanPeriod::add(double stamp_s) {
  if (last_stamp_s_) {
    const double distance_s = stamp_s - *last_stamp_s_;
    if (distance_s >= kShortestScan_s && distance_s <= kLongestScan_s) distances_s_[count_++ % kMost] = distance_s;
  }
  last_stamp_s_ = stamp_s;
}

double ScanPeriod::seconds() const {
  if (known_s_ > 0.0) return known_s_;
  if (count_ == 0) return kUsualPeriod_s;
  std::array<double, kMost> sorted_s = distances_s_;
  const auto end = sorted_s.begin() + static_cast<std::ptrdiff_t>(std::min(count_, kMost));
  const auto middle = sorted_s.begin() + (end - sorted_s.begin()) / 2;
  std::nth_element(sorted_s.begin(), middle, end);
  return *middle;
}

void MovingSource::take(const SourcePoints& source, const std::vector<float>& times_s) {
  source_ = &source;
  times_s_ = &times_s;
  float reach_s = 0.0F;
  for (const float time_s : times_s) reach_s = std::max(reach_s, std::abs(time_s));
  reach_s_ = static_cast<double>(reach_s);
  moved_.label = source.label;
  moved_.labelled = source.labelled;
}

const SourcePoints& MovingSource::compensatedBy(const ScanMotion& motion) {
  if (!hasTimes() || shiftBetween(motion, ScanMotion(), reach_s_) < kNegligibleShift_m) return *source_;
  compensate(*source_, *times_s_, motion, moved_);
  return moved_;
}

}  // namespace saw_ndt::internal
