#pragma once

#include <algorithm>
#include <string>

#include "simulation/simulated_drive.h"

namespace saw_ndt {

/// The first few hundred metres of a scene of this project.
inline SceneDescription shortScene(const std::string& name) {
  SceneDescription description =
      readSceneDescription(std::string(SAW_NDT_SOURCE_DIR) + "/data/scenes/" + name + ".json");
  description.course.resize(std::min<std::size_t>(description.course.size(), 4));
  return description;
}

/// A drive through shortScene(); with 0 scans to its end.
inline SimulatedDrive shortDrive(const std::string& name, const DriveOptions& options = {}, int scans = 30) {
  return driveCourse(shortScene(name), options, 0.1, scans);
}

}  // namespace saw_ndt
