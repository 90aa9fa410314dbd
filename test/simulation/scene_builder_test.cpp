#include "simulation/scene_builder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "expect_throws.h"
#include "simulation/short_drive.h"

namespace saw_ndt {
namespace {

using Place = std::array<float, 3>;

std::set<Place> placesOf(const Scene& scene) {
  std::set<Place> places;
  for (const PlacedObject& object : scene.objects) {
    const Eigen::Vector3f position = object.T_scene_object.translation();
    places.insert({position.x(), position.y(), position.z()});
  }
  return places;
}

TEST(SceneBuilder, DrivesShareWhatStandsAndDifferInWhatMoves) {
  DriveOptions second;
  second.drive = 2;
  const Scene a = shortDrive("residential").scene, b = shortDrive("residential").scene,
              c = shortDrive("residential", second).scene;
  EXPECT_EQ(placesOf(a), placesOf(b));
  std::vector<Place> common;
  const std::set<Place> places_a = placesOf(a), places_c = placesOf(c);
  std::set_intersection(places_a.begin(), places_a.end(), places_c.begin(), places_c.end(), std::back_inserter(common));
  // Parked cars alone differ.
  EXPECT_GT(common.size(), places_a.size() * 8 / 10);
  EXPECT_LT(common.size(), places_a.size());
  EXPECT_GT(places_c.size(), common.size());
}

TEST(SceneBuilder, NothingStandsInTheVehiclesWay) {
  for (const char* name : {"residential", "highway", "rural", "tunnel", "bridge", "equal_houses"}) {
    const SimulatedDrive around = shortDrive(name);
    const Scene& scene = around.scene;
    ASSERT_GT(scene.objects.size(), 50U) << name;
    for (std::size_t i = 1; i < scene.objects.size(); ++i) {  // the first is the ground
      const PlacedObject& object = scene.objects[i];
      const TriangleMesh& mesh = scene.meshes.at(object.mesh);
      for (const Eigen::Vector3f& vertex : mesh.vertices) {
        const Eigen::Vector3d point = (object.T_scene_object * vertex).cast<double>();
        if (point.z() - around.terrain->height(point.head<2>()) > 2.2) continue;  // above the vehicle
        for (const std::uint32_t station : around.route->stationsNear(point.head<2>(), 3.0)) {
          const RouteStation& at = around.route->stations()[station];
          // A vehicle of 1.8 m within 0.6 m of its lane's middle has this much room, and more.
          ASSERT_GT((point.head<2>() - at.position.head<2>()).norm(), 1.4) << name << ": object " << i;
        }
        if (mesh.vertices.size() > 2000) break;  // a crown: one leaf will do
      }
    }
  }
}

TEST(SceneBuilder, TrafficMovesAtItsSpeedAndNeverThroughTheVehicle) {
  const SimulatedDrive around = shortDrive("highway", {}, 100);
  const Scene& scene = around.scene;
  ASSERT_GT(scene.moving_objects.size(), 10U);
  int seen = 0;
  for (const MovingObject& object : scene.moving_objects) {
    // What drives ahead of the vehicle stops where its way ends, less than 2.5 s before the end.
    for (int i = 1; i + 25 < around.motion->scanCount(); i += 7) {
      const double stamp_s = around.motion->stamps_s[static_cast<std::size_t>(i)];
      const Eigen::Vector3d now = object.T_scene_object(stamp_s).translation();
      const Eigen::Vector3d later = object.T_scene_object(stamp_s + 0.01).translation();
      if (now.z() < -1000.0 || later.z() < -1000.0) continue;
      ++seen;
      const double speed = (later - now).norm() / 0.01;
      EXPECT_GT(speed, 19.0);
      EXPECT_LT(speed, 36.0);
      const Eigen::Vector3d own = around.motion->T_scene_lidar[static_cast<std::size_t>(i)].translation();
      EXPECT_GT((now - own).head<2>().norm(), 2.0);
    }
  }
  EXPECT_GT(seen, 50);
}

TEST(SceneBuilder, ARowKeepsToItsStretchOfTheWayAndMayBeOfEqualObjects) {
  SceneDescription description = shortScene("highway");
  ObjectRow row;
  row.object = "building";
  row.from_edge_m = {5, 5};
  row.spacing_m = {20, 20};
  row.length_m = row.width_m = row.height_m = {6, 9};
  row.along_m = {100, 200};
  row.alike = true;
  description.rows = {row};
  description.traffic.clear();
  const SimulatedDrive around = driveCourse(description, {}, 0.1, 10);
  ASSERT_EQ(around.scene.objects.size(), 11U);  // the ground, and five to either side
  for (std::size_t i = 1; i < around.scene.objects.size(); ++i) {
    const PlacedObject& object = around.scene.objects[i];
    EXPECT_EQ(object.mesh, around.scene.objects[1].mesh);
    const float along_m = object.T_scene_object.translation().x();  // the course begins with a straight
    EXPECT_GE(along_m, 99.0f);
    EXPECT_LE(along_m, 201.0f);
  }
}

TEST(SceneBuilder, FewerObjectsAreSomeOfTheSameObjects) {
  DriveOptions sparse;
  sparse.object_density = 0.67;
  const std::set<Place> all = placesOf(shortDrive("rural").scene), some = placesOf(shortDrive("rural", sparse).scene);
  std::vector<Place> common;
  std::set_intersection(all.begin(), all.end(), some.begin(), some.end(), std::back_inserter(common));
  EXPECT_LT(some.size(), all.size() * 8 / 10);
  // The others had no room beside one that is missing now.
  EXPECT_GT(common.size(), some.size() * 95 / 100);
}

TEST(SceneBuilder, DensitiesThinObjectsAndTraffic) {
  DriveOptions sparse;
  sparse.object_density = 0.0;
  sparse.traffic_density = 0.0;
  const Scene scene = shortDrive("rural", sparse).scene;
  EXPECT_EQ(scene.objects.size(), 1U);
  EXPECT_TRUE(scene.moving_objects.empty());
  sparse.object_density = 1.5;
  expectThrows<std::invalid_argument>([&] { shortDrive("rural", sparse); }, {"object_density = 1.5"});
}

}  // namespace
}  // namespace saw_ndt
