#include "synthetic_city.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "saw_ndt/common/geometry.h"

namespace saw_ndt {
namespace {

constexpr int kBlock = 40;          // edge of a city block (voxels)
constexpr int kWallRemainder = 20;  // columns of this remainder hold a wall
constexpr int kWallHeight = 4;      // voxels
constexpr double kWalls_m[] = {20.5, -19.5};
constexpr double kGround_m = 0.5;
constexpr double kSensorHeight_m = 1.7;
constexpr float kNoise_m = 0.01F;
constexpr int kRings = 64;
constexpr double kTopElevation_deg = 2.0, kBottomElevation_deg = -24.0;

// Nine points of a square that fills a voxel but for its margin, at right angles to an axis.
VoxelSums squareAcross(std::size_t axis) {
  VoxelSums sums;
  for (int i = -1; i <= 1; ++i) {
    for (int j = -1; j <= 1; ++j) {
      std::array<std::int32_t, 3> steps{};
      steps[axis] = (i + j) % 2 == 0 ? 600 : -600;
      steps[(axis + 1) % 3] = i * 24000;
      steps[(axis + 2) % 3] = j * 24000;
      sums.add(steps);
    }
  }
  return sums;
}

bool inWall(int coordinate) { return ((coordinate % kBlock) + kBlock) % kBlock == kWallRemainder; }

class Noise {
 public:
  float operator()() { return normal_(random_); }

 private:
  std::mt19937 random_{1};
  std::normal_distribution<float> normal_{0.0F, kNoise_m};
};

}  // namespace

NdtTarget cityTarget(std::size_t voxel_count) {
  const VoxelSums squares[3] = {squareAcross(0), squareAcross(1), squareAcross(2)};
  std::vector<LabelledVoxelSums> entries;
  entries.reserve(voxel_count);
  const auto add = [&](int x, int y, int z, StructuralLabel label, std::size_t across) {
    if (entries.size() < voxel_count) entries.push_back({{x, y, z}, label, squares[across]});
  };
  const auto addColumn = [&](int x, int y) {
    add(x, y, 0, StructuralLabel::GROUND, 2);
    if (!inWall(x) && !inWall(y)) return;
    for (int z = 1; z <= kWallHeight; ++z) add(x, y, z, StructuralLabel::NON_GROUND, inWall(x) ? 0 : 1);
  };
  addColumn(0, 0);
  // Square rings of columns around the middle.
  for (int ring = 1; entries.size() < voxel_count; ++ring) {
    for (int i = -ring; i <= ring; ++i) {
      addColumn(i, -ring);
      addColumn(i, ring);
    }
    for (int i = -ring + 1; i < ring; ++i) {
      addColumn(-ring, i);
      addColumn(ring, i);
    }
  }
  MapOrigin origin;
  origin.labelled = true;
  origin.scan_count = 1;
  origin.point_count = voxel_count * squares[0].count;
  return NdtTarget(WeightedVoxelMap(origin, std::move(entries)));
}

SourcePoints cityScan(std::size_t point_count) {
  const Eigen::Vector3d sensor(0.3, 0.2, kGround_m + kSensorHeight_m);
  SourcePoints source;
  source.reserve(point_count);
  source.labelled = true;
  Noise noise;
  const std::size_t columns = (point_count + kRings - 1) / kRings;
  for (std::size_t i = 0; i < point_count; ++i) {
    const double elevation = radiansFromDegrees(kTopElevation_deg + (kBottomElevation_deg - kTopElevation_deg) *
                                                                        static_cast<double>(i / columns) / kRings);
    const double azimuth = 2.0 * kPi * static_cast<double>(i % columns) / static_cast<double>(columns);
    const Eigen::Vector3d ray(std::cos(azimuth) * std::cos(elevation), std::sin(azimuth) * std::cos(elevation),
                              std::sin(elevation));
    double range = 1e3;
    StructuralLabel label = StructuralLabel::NON_GROUND;
    for (const double wall : kWalls_m) {
      for (const int axis : {0, 1}) {
        const double to_wall = (wall - sensor[axis]) / ray[axis];
        if (to_wall > 0.0) range = std::min(range, to_wall);
      }
    }
    const double to_ground = (kGround_m - sensor.z()) / ray.z();
    if (to_ground > 0.0 && to_ground < range) {
      range = to_ground;
      label = StructuralLabel::GROUND;
    }
    const Eigen::Vector3f point = (sensor + range * ray).cast<float>();
    source.add(point.x() + noise(), point.y() + noise(), point.z() + noise(), label);
  }
  return source;
}

SourcePoints cityPatch(std::size_t point_count) {
  SourcePoints source;
  source.reserve(point_count);
  source.labelled = true;
  std::mt19937 random(1);
  std::uniform_real_distribution<float> within(0.1F, 0.9F);
  Noise noise;
  for (std::size_t i = 0; i < point_count; ++i) {
    const float x = within(random), y = within(random);
    source.add(x, y, static_cast<float>(kGround_m) + noise(), StructuralLabel::GROUND);
  }
  return source;
}

}  // namespace saw_ndt
