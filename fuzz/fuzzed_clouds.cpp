#include "fuzzed_clouds.h"

#include <cmath>
#include <limits>

namespace saw_ndt {
namespace {

/// The ground, two walls and poles of a street, as a LiDAR 1.7 m above the ground sees them.
void addStreet(std::vector<LidarPoint>& points, float spacing_m) {
  constexpr float kLength_m = 10.0F;
  for (float x = -kLength_m; x <= kLength_m; x += spacing_m) {
    for (float y = -6.0F; y <= 6.0F; y += spacing_m) points.push_back({x, y, -1.7F + 0.01F * std::sin(7.0F * x), 0.3F});
    for (float z = -1.5F; z <= 2.0F; z += spacing_m) {
      points.push_back({x, 6.5F + 0.02F * std::sin(5.0F * x + z), z, 0.5F});
      points.push_back({x, -7.0F, z, 0.5F});
      if (std::fmod(std::abs(x), 8.0F) < spacing_m) points.push_back({x, 4.0F, z, 0.9F});
    }
  }
}

/// Points of a small patch, so that voxels have enough of them.
void addPatch(FuzzedDataProvider& provider, std::vector<LidarPoint>& points) {
  const float scale = provider.ConsumeBool() ? 0.005F : 1.0F;
  const LidarPoint corner{anyFloat(provider, scale), anyFloat(provider, scale), anyFloat(provider, scale), 0.5F};
  const auto shape = provider.ConsumeIntegral<std::uint8_t>();
  const int count = shape % 32;
  for (int i = 0; i < count; ++i) {
    const float a = 0.05F * static_cast<float>(i % 6), b = 0.05F * static_cast<float>(i / 6);
    LidarPoint point = corner;
    if ((shape & 0x20U) != 0) point.x += a;
    if ((shape & 0x40U) != 0) point.y += b;
    if ((shape & 0x80U) != 0) point.z += a * b;
    points.push_back(point);
  }
}

}  // namespace

float anyFloat(FuzzedDataProvider& provider, float scale) {
  constexpr float kSpecial[] = {std::numeric_limits<float>::quiet_NaN(),
                                std::numeric_limits<float>::infinity(),
                                -std::numeric_limits<float>::infinity(),
                                std::numeric_limits<float>::max(),
                                std::numeric_limits<float>::lowest(),
                                std::numeric_limits<float>::denorm_min(),
                                std::numeric_limits<float>::min(),
                                1e30F,
                                -1e30F,
                                1e9F,
                                -1.0001e9F,
                                524288.0F,
                                2147483648.0F,
                                -2147483648.0F,
                                1e-20F,
                                -0.0F};
  const auto number = provider.ConsumeIntegral<std::int16_t>();
  constexpr int kOrdinary = 32000;
  if (std::abs(static_cast<int>(number)) <= kOrdinary) return scale * static_cast<float>(number);
  return kSpecial[static_cast<unsigned>(number) % std::size(kSpecial)];
}

ScanPoints anyScan(FuzzedDataProvider& provider) {
  ScanPoints scan;
  const auto form = provider.ConsumeIntegral<std::uint8_t>();
  if ((form & 1U) != 0) addStreet(scan.points, (form & 2U) != 0 ? 0.4F : 0.8F);
  const auto patches = provider.ConsumeIntegralInRange<int>(0, 64);
  for (int i = 0; i < patches && provider.remaining_bytes() > 0; ++i) addPatch(provider, scan.points);
  const std::size_t count = scan.points.size();
  if ((form & 4U) != 0) {
    for (std::size_t i = 0; i < count; ++i) scan.rings.push_back(provider.ConsumeIntegral<std::uint8_t>());
  }
  if ((form & 8U) != 0) {
    const double start_s = static_cast<double>(anyFloat(provider, 1.0F));
    const double step_s = static_cast<double>(anyFloat(provider, 1e-8F));
    for (std::size_t i = 0; i < count; ++i) scan.times_s.push_back(start_s + step_s * static_cast<double>(i));
  }
  if ((form & 16U) != 0) {
    scan.height = provider.ConsumeIntegralInRange<std::size_t>(1, 130);
    scan.width = count / scan.height;
    scan.points.resize(scan.width * scan.height);
    if (!scan.rings.empty()) scan.rings.resize(scan.points.size());
    if (!scan.times_s.empty()) scan.times_s.resize(scan.points.size());
  }
  return scan;
}

std::vector<StructuralLabel> anyLabels(FuzzedDataProvider& provider, std::size_t count) {
  std::vector<StructuralLabel> labels(count);
  const auto pattern = provider.ConsumeIntegralInRange<unsigned>(1, 255);
  for (std::size_t i = 0; i < count; ++i) labels[i] = static_cast<StructuralLabel>(i / pattern % 3);
  return labels;
}

Eigen::Isometry3d anyPose(FuzzedDataProvider& provider, double reach_m) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  for (int axis = 0; axis < 3; ++axis) {
    T.translation()[axis] = static_cast<double>(anyFloat(provider, static_cast<float>(reach_m / 32000.0)));
  }
  Eigen::Vector3d turn;
  for (int axis = 0; axis < 3; ++axis) turn[axis] = 1e-4 * provider.ConsumeIntegral<std::int16_t>();
  if (turn.norm() > 0.0) T.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  if (provider.ConsumeIntegral<std::uint8_t>() == 255) T.linear() *= static_cast<double>(anyFloat(provider, 0.01F));
  return T;
}

SourcePoints anySource(FuzzedDataProvider& provider) {
  const ScanPoints scan = anyScan(provider);
  const bool labelled = provider.ConsumeBool();
  const std::vector<StructuralLabel> labels = anyLabels(provider, scan.points.size());
  SourcePoints source;
  source.labelled = labelled;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const LidarPoint& point = scan.points[i];
    if (!isWithinReach(point.x, point.y, point.z)) continue;
    source.add(point.x, point.y, point.z, labelled ? labels[i] : StructuralLabel::NON_GROUND);
  }
  return source;
}

}  // namespace saw_ndt
