#include "simulation/scene_description.h"

#include "expect_throws.h"
#include "saw_ndt/common/error.h"
#include "temporary_folder.h"

namespace saw_ndt {
namespace {

const std::filesystem::path kScenes = std::filesystem::path(SAW_NDT_SOURCE_DIR) / "data" / "scenes";

TEST(SceneDescription, ReadsTheScenesOfThisProject) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kScenes)) {
    const SceneDescription scene = readSceneDescription(entry.path());
    EXPECT_EQ(scene.name, entry.path().stem());
    EXPECT_FALSE(scene.course.empty());
    EXPECT_FALSE(scene.rows.empty());
    EXPECT_FALSE(scene.traffic.empty());
    ++count;
  }
  EXPECT_EQ(count, 7);
}

TEST(SceneDescription, ReadsEveryKindOfMember) {
  const TemporaryFolder folder;
  const auto path = folder.write("a.json", R"({
    // two rows
    "name": "a", "speed_mps": 5, "road": {"left_m": 3}, "course": [{"length_m": 10}, {"length_m": 20, "turn_deg": -90}],
    "rows": [{"object": "pole", "left": false, "from_edge_m": [1, 2], "spacing_m": 7, "length_m": 0.1, "width_m": 0.1,
              "height_m": [2, 3], "per_drive": true, "alike": true, "along_m": [20, 30]}]
  })");
  const SceneDescription scene = readSceneDescription(path);
  EXPECT_EQ(scene.speed_mps, 5.0);
  EXPECT_EQ(scene.road.left_m, 3.0);
  EXPECT_EQ(scene.road.right_m, RoadDescription().right_m);
  ASSERT_EQ(scene.course.size(), 2U);
  EXPECT_EQ(scene.course[1].turn_deg, -90.0);
  ASSERT_EQ(scene.rows.size(), 1U);
  EXPECT_FALSE(scene.rows[0].left);
  EXPECT_TRUE(scene.rows[0].right);
  EXPECT_TRUE(scene.rows[0].per_drive);
  EXPECT_TRUE(scene.rows[0].alike);
  EXPECT_EQ(scene.rows[0].along_m.min, 20.0);
  EXPECT_EQ(scene.rows[0].along_m.max, 30.0);
  EXPECT_EQ(scene.rows[0].from_edge_m.max, 2.0);
  EXPECT_EQ(scene.rows[0].spacing_m.min, 7.0);
  EXPECT_EQ(scene.rows[0].spacing_m.max, 7.0);
}

TEST(SceneDescription, WhatIsWrongIsNamed) {
  const TemporaryFolder folder;
  const auto expectRefused = [&folder](const std::string& text, std::initializer_list<std::string> parts) {
    const auto path = folder.write("bad.json", text);
    expectThrows<Error>([&] { readSceneDescription(path); }, parts);
  };
  const std::string pole = R"("object": "pole", "length_m": 0.1, "width_m": 0.1, "height_m": 2)";
  expectRefused("", {"bad.json"});
  expectRefused("[1]", {"bad.json", "must be an object"});
  expectRefused(R"({"name": "a", "sped_mps": 3})", {"bad.json", "sped_mps", "unknown"});
  expectRefused(R"({"name": "a", "speed_mps": "fast"})", {"speed_mps", "must be a number"});
  expectRefused(R"({"name": "a", "speed_mps": -3})", {"speed_mps = -3"});
  expectRefused(R"({"name": "a", "road": {"left": 3}})", {"road.left", "unknown"});
  expectRefused(R"({"name": "a", "rows": [{)" + pole + R"(}, {"object": "dragon"}]})", {"object = dragon"});
  expectRefused(R"({"name": "a", "rows": [{)" + pole + R"(, "spacing_m": 0}]})", {"spacing_m = 0"});
  expectRefused(R"({"name": "a", "rows": [{)" + pole + R"(, "from_edge_m": [2, 1]}]})", {"from_edge_m"});
  expectRefused(R"({"name": "a", "rows": [{)" + pole + R"(, "along_m": [-5, 10]}]})", {"along_m = -5"});
  expectRefused(R"({"name": "a", "traffic": [{)" + pole + R"(, "per_km": -1}]})", {"per_km = -1"});
  expectThrows<Error>([&] { readSceneDescription(folder.path() / "none.json"); }, {"none.json"});
}

}  // namespace
}  // namespace saw_ndt
