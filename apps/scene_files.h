#pragma once

#include <filesystem>
#include <string>

namespace saw_ndt {

/// The file of a scene: `scene` itself where it is a file, or NAME.json among the scenes that come with the program
/// (../share/saw_ndt/scenes from where it lies). @throws UsageError that lists them where there is none such
std::filesystem::path sceneFile(const std::string& scene);

}  // namespace saw_ndt
