#include <chrono>
#include <cmath>
#include <iostream>
#include <random>

#include "app_options.h"
#include "simulation/lidar_simulator.h"

namespace {

using saw_ndt::Scene;
using saw_ndt::TriangleMesh;

/// Rolling ground of `side` x `side` metres, two triangles a half square metre.
TriangleMesh rollingGround(int side) {
  TriangleMesh mesh;
  const std::uint32_t n = 2 * side;
  for (std::uint32_t i = 0; i <= n; ++i) {
    for (std::uint32_t j = 0; j <= n; ++j) {
      const float x = 0.5F * static_cast<float>(i) - 0.5F * static_cast<float>(side);
      const float y = 0.5F * static_cast<float>(j) - 0.5F * static_cast<float>(side);
      mesh.vertices.emplace_back(x, y, 0.3F * std::sin(0.05F * x) * std::cos(0.07F * y));
    }
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t a = i * (n + 1) + j, b = a + n + 1;
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
    }
  }
  mesh.materials.assign(mesh.triangles.size(), 0);
  return mesh;
}

/// Triangles of a few centimetres anywhere in a ball: a twig, a bush or a crown.
TriangleMesh leaves(int count, float radius, float size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(-1.0F, 1.0F);
  TriangleMesh mesh;
  for (int leaf = 0; leaf < count; ++leaf) {
    Eigen::Vector3f centre;
    do {
      centre = {uniform(random), uniform(random), uniform(random)};
    } while (centre.norm() > 1.0F);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (int corner = 0; corner < 3; ++corner) {
      mesh.vertices.push_back(radius * centre +
                              size * Eigen::Vector3f(uniform(random), uniform(random), uniform(random)));
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.materials.push_back(1);
  }
  return mesh;
}

TriangleMesh box(const Eigen::Vector3f& half) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back((i & 1 ? 1.0F : -1.0F) * half.x(), (i & 2 ? 1.0F : -1.0F) * half.y(),
                               (i & 4 ? 1.0F : -1.0F) * half.z());
  }
  mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 3, 7}, {1, 7, 5}};
  mesh.materials.assign(mesh.triangles.size(), 2);
  return mesh;
}

/// A street between houses and trees: ground of 1.3 million triangles, 40,000 crowns and bushes of 2,000 leaves each,
/// 400 houses and 30 cars that drive.
Scene crowdedScene() {
  Scene scene;
  scene.materials = {{40, 0.2F}, {70, 0.35F}, {50, 0.4F}, {10, 0.1F}};
  scene.meshes = {rollingGround(400), leaves(2000, 2.0F, 0.1F, 1), leaves(2000, 0.8F, 0.06F, 2), box({6, 5, 5}),
                  box({2.2F, 0.9F, 0.75F})};
  scene.objects.push_back({0, Eigen::Affine3f::Identity()});
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(-1.0F, 1.0F);
  const auto place = [&](std::uint32_t mesh, float z, float clear) {
    Eigen::Vector3f position;
    do {
      position = {200.0F * uniform(random), 200.0F * uniform(random), z};
    } while (std::abs(position.y()) < clear);
    Eigen::Affine3f T(Eigen::Translation3f{position});
    T.rotate(Eigen::AngleAxisf(3.0F * uniform(random), Eigen::Vector3f::UnitZ()));
    scene.objects.push_back({mesh, T});
  };
  for (int i = 0; i < 20000; ++i) place(1, 5.0F, 7.0F);
  for (int i = 0; i < 20000; ++i) place(2, 0.5F, 6.0F);
  for (int i = 0; i < 400; ++i) place(3, 5.0F, 14.0F);
  for (int car = 0; car < 30; ++car) {
    scene.moving_objects.push_back(
        {4, [car](double stamp_s) {
           const double lane = car % 2 == 0 ? 1.0 : -1.0;
           return Eigen::Isometry3d(Eigen::Translation3d(12.0 * (car - 15) + lane * 12.0 * stamp_s, lane * 2.5, 0.9));
         }});
  }
  return scene;
}

}  // namespace

// Prints how fast scans of a crowded street are simulated.
int main(int argc, char** argv) {
  saw_ndt::AppOptions app("lidar_benchmark", "Measures how fast scans of a crowded street are simulated.");
  int scans = 40;
  std::string sensor = "HDL-64E";
  bool rolling_shutter = false;
  app.addOption("scans", &scans, "COUNT", "scans to cast");
  app.addOption("sensor", &sensor, "NAME", "sensor model");
  app.addFlag("rolling-shutter", &rolling_shutter, "leave the motion of the LiDAR in the scans");
  return saw_ndt::runApp(argc, argv, app, [&] {
    using Clock = std::chrono::steady_clock;
    const auto secondsSince = [](Clock::time_point start) {
      return std::chrono::duration<double>(Clock::now() - start).count();
    };
    saw_ndt::LidarOptions options = saw_ndt::LidarOptions::named(sensor);
    options.rolling_shutter = rolling_shutter;
    const Scene scene = crowdedScene();
    saw_ndt::VehicleMotion motion;
    for (int scan = 0; scan < scans; ++scan) {
      motion.stamps_s.push_back(0.1 * scan);
      motion.T_scene_lidar.emplace_back(Eigen::Translation3d(1.0 * scan - 20.0, -1.5, 1.9));
    }
    Clock::time_point start = Clock::now();
    saw_ndt::LidarSimulator simulator(scene, options, app.threads());
    const double preparation_s = secondsSince(start);
    start = Clock::now();
    std::size_t points = 0;
    for (int scan = 0; scan < scans; ++scan) points += simulator.scan(motion, scan).points.size();
    const double elapsed_s = secondsSince(start);
    std::cout << "scene prepared in " << preparation_s << " s; " << scans / elapsed_s << " scans/s, "
              << points / static_cast<std::size_t>(scans) << " points a scan\n";
  });
}
