#include "simulation/scene_description.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "common/input_file.h"
#include "report/member_reader.h"
#include "saw_ndt/common/error.h"
#include "simulation/object_meshes.h"

namespace saw_ndt {

using namespace internal;

namespace {

using nlohmann::json;

void readRange(MemberReader& reader, const char* name, ValueRange& range) {
  reader.readRange(name, range.min, range.max);
}

void readRoad(MemberReader& reader, RoadDescription& road) {
  reader.read("left_m", road.left_m);
  reader.read("right_m", road.right_m);
  reader.read("kerb_height_m", road.kerb_height_m);
  reader.read("sidewalk_width_m", road.sidewalk_width_m);
}

void readTerrain(MemberReader& reader, TerrainDescription& terrain) {
  reader.read("hill_height_m", terrain.hill_height_m);
  reader.read("hill_length_m", terrain.hill_length_m);
  reader.read("bank_height_m", terrain.bank_height_m);
  reader.read("bank_width_m", terrain.bank_width_m);
  reader.read("undulation_m", terrain.undulation_m);
  reader.read("roughness_m", terrain.roughness_m);
}

void readCourseElement(MemberReader& reader, CourseElement& element) {
  reader.read("length_m", element.length_m);
  reader.read("turn_deg", element.turn_deg);
}

template <typename Sized>
void readSize(MemberReader& reader, Sized& element) {
  readRange(reader, "length_m", element.length_m);
  readRange(reader, "width_m", element.width_m);
  readRange(reader, "height_m", element.height_m);
}

void readRow(MemberReader& reader, ObjectRow& row) {
  reader.read("object", row.object);
  reader.read("left", row.left);
  reader.read("right", row.right);
  readRange(reader, "from_edge_m", row.from_edge_m);
  readRange(reader, "along_m", row.along_m);
  readRange(reader, "spacing_m", row.spacing_m);
  readRange(reader, "section_m", row.section_m);
  reader.read("probability", row.probability);
  readSize(reader, row);
  reader.read("heading_deg", row.heading_deg);
  reader.read("alike", row.alike);
  reader.read("per_drive", row.per_drive);
}

void readStream(MemberReader& reader, TrafficStream& stream) {
  reader.read("object", stream.object);
  readRange(reader, "lateral_m", stream.lateral_m);
  readRange(reader, "speed_mps", stream.speed_mps);
  reader.read("per_km", stream.per_km);
  readRange(reader, "headway_s", stream.headway_s);
  readSize(reader, stream);
}

void readScene(MemberReader& reader, SceneDescription& scene) {
  reader.read("name", scene.name);
  reader.read("road", scene.road, readRoad);
  reader.read("terrain", scene.terrain, readTerrain);
  reader.read("course", scene.course, readCourseElement);
  reader.read("speed_mps", scene.speed_mps);
  reader.read("lateral_acceleration_mps2", scene.lateral_acceleration_mps2);
  reader.read("rows", scene.rows, readRow);
  reader.read("traffic", scene.traffic, readStream);
}

void checkRange(const char* name, const ValueRange& range, double least, double greatest, const char* requirement) {
  checkOption(range.min >= least && range.max <= greatest, name, range.min < least ? range.min : range.max,
              requirement);
  checkOption(range.min <= range.max, name, range.max, "at least the range's first value");
}

template <typename Sized>
void checkObject(const Sized& element) {
  bool known = false;
  for (const std::string& kind : objectKinds()) known = known || kind == element.object;
  std::string kinds = "one of";
  for (const std::string& kind : objectKinds()) kinds += " " + kind;
  checkOption(known, "object", element.object, kinds.c_str());
  for (const auto& [name, range] : {std::pair<const char*, ValueRange>{"length_m", element.length_m},
                                    {"width_m", element.width_m},
                                    {"height_m", element.height_m}}) {
    checkRange(name, range, 0.02, 200.0, "between 0.02 and 200");
  }
}

}  // namespace

void SceneDescription::check() const {
  checkOption(!name.empty(), "name", name, "stated");
  checkOption(road.left_m >= 1.0 && road.left_m <= 50.0, "road.left_m", road.left_m, "between 1 and 50");
  checkOption(road.right_m >= 1.0 && road.right_m <= 50.0, "road.right_m", road.right_m, "between 1 and 50");
  checkOption(road.kerb_height_m >= 0.0 && road.kerb_height_m <= 1.0, "road.kerb_height_m", road.kerb_height_m,
              "between 0 and 1");
  checkOption(road.sidewalk_width_m >= 0.0 && road.sidewalk_width_m <= 20.0, "road.sidewalk_width_m",
              road.sidewalk_width_m, "between 0 and 20");
  checkOption(std::abs(terrain.hill_height_m) <= 50.0, "terrain.hill_height_m", terrain.hill_height_m,
              "between -50 and 50");
  checkOption(terrain.hill_length_m >= 20.0, "terrain.hill_length_m", terrain.hill_length_m, "at least 20");
  checkOption(std::abs(terrain.bank_height_m) <= 30.0, "terrain.bank_height_m", terrain.bank_height_m,
              "between -30 and 30");
  checkOption(terrain.bank_width_m > 0.0, "terrain.bank_width_m", terrain.bank_width_m, "greater than 0");
  checkOption(terrain.undulation_m >= 0.0 && terrain.undulation_m <= 10.0, "terrain.undulation_m", terrain.undulation_m,
              "between 0 and 10");
  checkOption(terrain.roughness_m >= 0.0 && terrain.roughness_m <= 0.5, "terrain.roughness_m", terrain.roughness_m,
              "between 0 and 0.5");
  checkOption(speed_mps > 0.0 && speed_mps <= 70.0, "speed_mps", speed_mps, "between 0, exclusive, and 70");
  checkOption(lateral_acceleration_mps2 >= 0.1, "lateral_acceleration_mps2", lateral_acceleration_mps2, "at least 0.1");
  for (const CourseElement& element : course) {
    checkOption(element.length_m > 0.0 && element.length_m <= 1e5, "course.length_m", element.length_m,
                "between 0, exclusive, and 100000");
    checkOption(std::abs(element.turn_deg) <= 360.0, "course.turn_deg", element.turn_deg, "between -360 and 360");
  }
  for (const ObjectRow& row : rows) {
    checkObject(row);
    checkRange("from_edge_m", row.from_edge_m, -50.0, 100.0, "between -50 and 100");
    checkRange("along_m", row.along_m, 0.0, 1e5, "between 0 and 100000");
    checkRange("spacing_m", row.spacing_m, 0.5, 1e5, "at least 0.5");
    checkRange("section_m", row.section_m, 0.0, 1e5, "at least 0");
    checkOption(row.probability >= 0.0 && row.probability <= 1.0, "probability", row.probability, "between 0 and 1");
  }
  for (const TrafficStream& stream : traffic) {
    checkObject(stream);
    checkRange("lateral_m", stream.lateral_m, -100.0, 100.0, "between -100 and 100");
    checkRange("speed_mps", stream.speed_mps, -70.0, 70.0, "between -70 and 70");
    checkRange("headway_s", stream.headway_s, -60.0, 60.0, "between -60 and 60");
    checkOption(stream.per_km >= 0.0 && stream.per_km <= 1000.0, "per_km", stream.per_km, "between 0 and 1000");
  }
}

SceneDescription readSceneDescription(const std::filesystem::path& path) {
  std::ifstream stream = openInputFile(path);
  SceneDescription scene;
  try {
    const json document = json::parse(stream, nullptr, true, /*ignore_comments=*/true);
    MemberReader reader(document, path.string(), "");
    readScene(reader, scene);
    reader.finish();
    scene.check();
  } catch (const json::exception& error) {
    throw Error(path.string(), "", error.what());
  } catch (const std::invalid_argument& error) {
    throw Error(path.string(), "", error.what());
  }
  return scene;
}

}  // namespace saw_ndt
