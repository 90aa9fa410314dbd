#include "scene_files.h"

#include <set>

#include "app_options.h"

namespace saw_ndt {

std::filesystem::path sceneFile(const std::string& scene) {
  std::error_code error;
  if (std::filesystem::is_regular_file(scene, error)) return scene;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::filesystem::path folder = program.parent_path().parent_path() / "share" / "saw_ndt" / "scenes";
  const std::filesystem::path file = folder / (scene + ".json");
  if (std::filesystem::is_regular_file(file, error)) return file;
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) names.insert(entry.path().stem());
  std::string message = "option -scene: '" + scene + "' is neither a file nor one of the scenes in " + folder.string();
  for (const std::string& name : names) message += " " + name;
  throw UsageError(message);
}

}  // namespace saw_ndt
