#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>

#include "common/middle_value.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/segmentation/scan_segmenter.h"
#include "saw_ndt/segmentation/sensor_setup.h"
#include "segmentation/segmentation_stages.h"

namespace saw_ndt {

using namespace internal;

namespace {

constexpr float kFarthest_m = 25.0F;
constexpr float kNearest_m = 1.0F;
constexpr std::size_t kMostPoints = 3000;
constexpr int kTrials = 1500;
constexpr float kInlier_m = 0.1F;
// What is farther behind a plane than this is not seen through the ground by chance.
constexpr float kBehind_m = 0.3F;
constexpr float kGreatestLeanCosine = 0.643F;  // 50 degrees
constexpr float kLeastHeight_m = 0.15F;
constexpr float kGreatestHeight_m = 10.0F;
constexpr double kLeastInlierShare = 0.08;
// A ceiling is as good a plane as a floor, and most sensors stand upright.
constexpr float kUpsideDownFactor = 0.5F;

/// Points x with up . x = -height.
struct Plane {
  Eigen::Vector3f up = Eigen::Vector3f::UnitZ();
  float height = 0.0F;
};

using Points = std::vector<Eigen::Vector3f>;

Points nearReturns(const ScanView& scan) {
  Points near;
  for (std::size_t i = 0; i < scan.size; ++i) {
    const Eigen::Map<const Eigen::Vector3f> point(scan.point(i));
    const float range = point.norm();
    if (range >= kNearest_m && range <= kFarthest_m) near.emplace_back(point);
  }
  return near;
}

/// Some of them, as many from everywhere: of cells of a metre one each, then a second one each and so on, so that what
/// the sensor sees densely, such as the rings around it, walls or a ramp ahead, is not all that counts.
Points spreadOut(Points near) {
  std::mt19937 random(1);
  std::shuffle(near.begin(), near.end(), random);
  constexpr int kSide = 2 * static_cast<int>(kFarthest_m) + 1;
  constexpr std::size_t kMostOfCell = 8;
  std::vector<std::uint8_t> taken(static_cast<std::size_t>(kSide) * kSide * kSide, 0);
  std::array<Points, kMostOfCell> turns;  // the first point of each cell, the second ones and so on
  for (const Eigen::Vector3f& point : near) {
    const Eigen::Vector3i cell = (point.array() + kFarthest_m).floor().cast<int>().min(kSide - 1);
    std::uint8_t& count = taken[static_cast<std::size_t>((cell.x() * kSide + cell.y()) * kSide + cell.z())];
    if (count == kMostOfCell) continue;
    turns[count].push_back(point);
    ++count;
  }
  Points spread;
  for (Points& turn : turns) {
    // Points of dense cells come first.
    std::shuffle(turn.begin(), turn.end(), random);
    const std::size_t wanted = std::min(turn.size(), kMostPoints - spread.size());
    spread.insert(spread.end(), turn.begin(), turn.begin() + static_cast<std::ptrdiff_t>(wanted));
  }
  return spread;
}

std::optional<Plane> planeThrough(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c) {
  const Eigen::Vector3f normal = (b - a).cross(c - a);
  const float length = normal.norm();
  if (length < 0.5F) return std::nullopt;
  Plane plane;
  plane.up = normal / length;
  plane.height = -plane.up.dot(a);
  // The sensor is above the ground.
  if (plane.height < 0.0F) {
    plane.up = -plane.up;
    plane.height = -plane.height;
  }
  return plane;
}

bool mayBeGround(const Plane& plane) {
  return std::abs(plane.up.z()) >= kGreatestLeanCosine && plane.height >= kLeastHeight_m &&
         plane.height <= kGreatestHeight_m;
}

struct Support {
  int on = 0;
  int behind = 0;
  /// The more the better: what lies behind counts against a plane.
  float score(const Plane& plane) const {
    const auto balance = static_cast<float>(on - 2 * behind);
    return plane.up.z() < 0.0F ? kUpsideDownFactor * balance : balance;
  }
};

Support supportOf(const Plane& plane, const Points& points) {
  Support support;
  for (const Eigen::Vector3f& point : points) {
    const float above = plane.up.dot(point) + plane.height;
    support.on += std::abs(above) <= kInlier_m ? 1 : 0;
    support.behind += above < -kBehind_m ? 1 : 0;
  }
  return support;
}

/// The plane of least squares through the points on a plane; nothing where they make no surface.
std::optional<Plane> fitted(const Plane& plane, const Points& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double count = 0.0;
  const auto is_on = [&](const Eigen::Vector3f& point) {
    return std::abs(plane.up.dot(point) + plane.height) <= kInlier_m;
  };
  for (const Eigen::Vector3f& point : points) {
    if (!is_on(point)) continue;
    mean += point.cast<double>();
    count += 1.0;
  }
  if (count < 3.0) return std::nullopt;
  mean /= count;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3f& point : points) {
    if (is_on(point)) scatter += (point.cast<double>() - mean) * (point.cast<double>() - mean).transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(scatter / count);
  constexpr double kLeastExtent_m = 0.5;  // standard deviation across: a line leaves a plane free
  if (!(axes.eigenvalues()(1) > kLeastExtent_m * kLeastExtent_m)) return std::nullopt;
  Plane better;
  better.up = axes.eigenvectors().col(0).cast<float>();
  if (better.up.dot(plane.up) < 0.0F) better.up = -better.up;
  better.height = -better.up.dot(mean.cast<float>());
  return better;
}

}  // namespace

std::optional<LearnedMounting> learnMounting(const ScanView& scan) {
  const Points returns = nearReturns(scan);
  const Points points = spreadOut(returns);
  constexpr std::size_t kLeastPoints = 100;
  if (points.size() < kLeastPoints) return std::nullopt;
  std::mt19937 random(2);
  std::optional<Plane> best;
  float best_score = 0.0F;
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto pick = [&]() -> const Eigen::Vector3f& { return points[random() % points.size()]; };
    // Points that are near one another are more often of one surface.
    const Eigen::Vector3f& first = pick();
    const auto pick_near = [&] {
      constexpr int kAttempts = 20;
      constexpr float kNear_m = 8.0F;
      const Eigen::Vector3f* near = &pick();
      for (int attempt = 1; attempt < kAttempts && (*near - first).norm() > kNear_m; ++attempt) near = &pick();
      return *near;
    };
    const auto plane = planeThrough(first, pick_near(), pick_near());
    if (!plane || !mayBeGround(*plane)) continue;
    const float score = supportOf(*plane, points).score(*plane);
    if (score <= best_score) continue;
    best_score = score;
    best = plane;
  }
  constexpr int kRefinements = 5;
  for (int i = 0; i < kRefinements && best; ++i) best = fitted(*best, returns);
  if (!best || !mayBeGround(*best)) return std::nullopt;
  const Support support = supportOf(*best, points);
  if (support.on < kLeastInlierShare * static_cast<double>(points.size()) || 2 * support.behind > support.on) {
    return std::nullopt;
  }
  // Of up = R_level_lidar^T e_z = (-sin pitch, cos pitch sin roll, cos pitch cos roll).
  const Eigen::Vector3d up = best->up.cast<double>();
  return LearnedMounting{degreesFromRadians(std::asin(std::clamp(-up.x(), -1.0, 1.0))),
                         degreesFromRadians(std::atan2(up.y(), up.z())), static_cast<double>(best->height)};
}

std::optional<LearnedMounting> learnMounting(const std::vector<ScanView>& scans) {
  std::vector<double> pitches_deg, rolls_deg, heights_m;
  for (const ScanView& scan : scans) {
    const auto mounting = learnMounting(scan);
    if (!mounting) continue;
    pitches_deg.push_back(mounting->pitch_deg);
    // Rolls about 180 degrees have both signs.
    const double turn_deg = rolls_deg.empty() ? 0.0 : 360.0 * std::round((rolls_deg[0] - mounting->roll_deg) / 360.0);
    rolls_deg.push_back(mounting->roll_deg + turn_deg);
    heights_m.push_back(mounting->height_m);
  }
  if (pitches_deg.empty()) return std::nullopt;
  const double roll_deg = middleValue(rolls_deg);
  return LearnedMounting{middleValue(pitches_deg), roll_deg - 360.0 * std::round(roll_deg / 360.0),
                         middleValue(heights_m)};
}

SegmentationOptions withMounting(const SegmentationOptions& options, const LearnedMounting& mounting,
                                 const ScanView& scan) {
  constexpr double kLevel_deg = 5.0;
  constexpr double kSameHeight_m = 0.3;
  SegmentationOptions result = options;
  const double lean_cosine =
      std::cos(radiansFromDegrees(mounting.pitch_deg)) * std::cos(radiansFromDegrees(mounting.roll_deg));
  if (lean_cosine < std::cos(radiansFromDegrees(kLevel_deg))) {
    result.mounting_pitch_deg = mounting.pitch_deg;
    result.mounting_roll_deg = mounting.roll_deg;
  }
  if (result.ground.sensor_height_m > 0.0 || result.ground.rule != GroundRule::GROWING) return result;
  ScanSegmenter segmenter(result);
  std::vector<StructuralLabel> labels;
  segmenter.segment(scan, labels);
  const double found_m = segmenter.stages().ground_detection.sensorHeight();
  if (std::abs(found_m - mounting.height_m) > kSameHeight_m) result.ground.sensor_height_m = mounting.height_m;
  return result;
}

}  // namespace saw_ndt
