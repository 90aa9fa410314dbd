#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace saw_ndt {

/// Values between which one is drawn, both included.
struct ValueRange {
  double min = 0.0;
  double max = 0.0;
};

/// The cross-section of the road, seen along the way that the vehicle takes.
struct RoadDescription {
  double left_m = 5.0;            ///< from the vehicle's way to the left edge
  double right_m = 2.5;           ///< from the vehicle's way to the right edge
  double kerb_height_m = 0.12;    ///< step at either edge; 0: none
  double sidewalk_width_m = 2.0;  ///< paved strip beyond either edge; 0: none
};

/// The ground beside the road.
struct TerrainDescription {
  double hill_height_m = 0.0;    ///< the road itself rises and falls by about this (where no trajectory tells)
  double hill_length_m = 200.0;  ///< from hill to hill
  double bank_height_m = 0.0;    ///< the ground rises (or falls: negative) by this beside the road
  double bank_width_m = 10.0;    ///< within this distance of the paved strip
  double undulation_m = 0.3;     ///< deviation of open ground over tens of metres, one sigma
  double roughness_m = 0.02;     ///< deviation of open ground over half a metre, one sigma
};

/// A straight or a bend of the course.
struct CourseElement {
  double length_m = 0.0;
  double turn_deg = 0.0;  ///< positive: to the left
};

/// Objects placed along the road.
struct ObjectRow {
  std::string object;              ///< one of objectKinds()
  bool left = true, right = true;  ///< on which sides
  ValueRange from_edge_m;          ///< of the near side from the edge of the road; negative: on the road
  ValueRange along_m{0, 1e5};      ///< the stretch of the way that the row is on, from its start
  ValueRange spacing_m{10, 10};    ///< from the middle of one to that of the next
  ValueRange section_m;            ///< where not 0: objects come in sections of this length, each all or none, in line
  double probability = 1.0;        ///< of an object or section
  ValueRange length_m, width_m, height_m;  ///< along the road, across, and up
  double heading_deg = 0.0;                ///< greatest deviation from the direction of the road
  bool alike = false;                      ///< all of them are the same, in size and in details
  bool per_drive = false;                  ///< drawn again for every drive
};

/// Vehicles or persons that move along the road.
struct TrafficStream {
  std::string object;                      ///< one of objectKinds()
  ValueRange lateral_m;                    ///< left of the vehicle's way
  ValueRange speed_mps;                    ///< negative: they come towards the vehicle
  double per_km = 0.0;                     ///< how many there are on a kilometre of the way
  ValueRange headway_s;                    ///< where not 0: one that keeps this far ahead of (or behind) the vehicle
  ValueRange length_m, width_m, height_m;  ///< along the road, across, and up
};

/// A kind of surroundings, as files of data/scenes state it.
struct SceneDescription {
  std::string name;
  RoadDescription road;
  TerrainDescription terrain;
  std::vector<CourseElement> course;  ///< the way where no trajectory is given
  double speed_mps = 10.0;
  double lateral_acceleration_mps2 = 2.0;  ///< at most, in bends
  std::vector<ObjectRow> rows;
  std::vector<TrafficStream> traffic;

  /// Throws std::invalid_argument that names the field and its value.
  void check() const;
};

/// Reads a description: JSON with `//` comments, members as the fields above; a field that is left out has its default.
/// @throws Error that names file, member and reason, for what is no such file, unknown members included
SceneDescription readSceneDescription(const std::filesystem::path& path);

}  // namespace saw_ndt
