#include "report/sensor_model_file.h"

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "common/input_file.h"
#include "report/member_reader.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt {

using namespace internal;

SensorModel readSensorModel(const std::filesystem::path& path) {
  std::ifstream stream = openInputFile(path);
  SensorModel model;
  try {
    const auto document = nlohmann::json::parse(stream, nullptr, true, /*ignore_comments=*/true);
    MemberReader reader(document, path.string(), "");
    for (const char* name : {"name", "columns", "elevations_deg"}) reader.require(name);
    reader.read("name", model.name);
    reader.read("columns", model.columns);
    reader.read("elevations_deg", model.elevations_deg);
    std::vector<std::string> other_names;
    reader.read("other_names", other_names);
    std::string source;
    reader.read("source", source);
    reader.finish();
    checkOption(!model.name.empty(), "name", model.name, "stated");
    model.check();
  } catch (const nlohmann::json::exception& error) {
    throw Error(path.string(), "", error.what());
  } catch (const std::invalid_argument& error) {
    throw Error(path.string(), "", error.what());
  }
  return model;
}

SensorModel sensorModelOf(const std::string& name_or_file) {
  if (std::filesystem::path(name_or_file).extension() == ".json") return readSensorModel(name_or_file);
  return SensorModel::named(name_or_file);
}

}  // namespace saw_ndt
