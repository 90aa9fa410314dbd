#include "report/sensor_model_file.h"

#include <gtest/gtest.h>

#include <set>
#include <stdexcept>

#include "expect_throws.h"
#include "saw_ndt/common/error.h"
#include "temporary_folder.h"

namespace saw_ndt {
namespace {

const std::filesystem::path kSensors = std::filesystem::path(SAW_NDT_SOURCE_DIR) / "data" / "sensors";

TEST(SensorModelFile, TheLibraryKnowsWhatTheFilesSay) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(kSensors)) {
    const SensorModel model = readSensorModel(entry.path());
    EXPECT_EQ(entry.path().stem(), model.name);
    const SensorModel known = SensorModel::named(model.name);
    EXPECT_EQ(known.columns, model.columns) << model.name;
    EXPECT_EQ(known.elevations_deg, model.elevations_deg) << model.name;  // to the bit
    names.insert(model.name);
  }
  for (const std::string& name : SensorModel::names()) {
    EXPECT_TRUE(names.count(name) == 1 || name == "OS-64" || name == "OS-128") << name;
  }
}

TEST(SensorModelFile, ReadsAnotherLidar) {
  const TemporaryFolder folder;
  const auto path = folder.write("mine.json", R"({
    // as measured
    "name": "mine", "columns": 900, "elevations_deg": [3, 0.5, -2.25]
  })");
  const SensorModel model = readSensorModel(path);
  EXPECT_EQ(model.name, "mine");
  EXPECT_EQ(model.columns, 900);
  EXPECT_EQ(model.elevations_deg, (std::vector<double>{3.0, 0.5, -2.25}));
  EXPECT_EQ(sensorModelOf(path.string()).rows(), 3);
  EXPECT_EQ(sensorModelOf("XT32").rows(), 32);
  expectThrows<std::invalid_argument>([] { sensorModelOf("mine"); }, {"mine", "XT32", "no-rings"});
}

TEST(SensorModelFile, WithoutBeamsHasNoRows) {
  const TemporaryFolder folder;
  const auto path = folder.write("flash.json", R"({"name": "flash", "columns": 900, "elevations_deg": []})");
  EXPECT_EQ(readSensorModel(path).rows(), 0);
}

TEST(SensorModelFile, NamesFileAndMemberOfWhatIsWrong) {
  const TemporaryFolder folder;
  const auto expectRefused = [&](const std::string& text, std::initializer_list<std::string> parts) {
    const auto path = folder.write("bad.json", text);
    expectThrows<Error>([&] { readSensorModel(path); }, {"bad.json"});
    expectThrows<Error>([&] { readSensorModel(path); }, parts);
  };
  expectRefused("", {"parse error"});
  expectRefused("[1]", {"must be an object"});
  expectRefused(R"({"columns": 900, "elevations_deg": [1]})", {"name", "is missing"});
  expectRefused(R"({"name": "a", "elevations_deg": [1]})", {"columns", "is missing"});
  expectRefused(R"({"name": "a", "columns": 900})", {"elevations_deg", "is missing"});
  expectRefused(R"({"name": 3, "columns": 900, "elevations_deg": [1]})", {"name: must be a text"});
  expectRefused(R"({"name": "", "columns": 900, "elevations_deg": [1]})", {"name = "});
  expectRefused(R"({"name": "a", "columns": 900.5, "elevations_deg": [1]})", {"columns: must be a whole number"});
  expectRefused(R"({"name": "a", "columns": 4294968196, "elevations_deg": [1]})", {"columns: must be a whole"});
  expectRefused(R"({"name": "a", "columns": "9", "elevations_deg": [1]})", {"columns: must be a whole number"});
  expectRefused(R"({"name": "a", "columns": 3, "elevations_deg": [1]})", {"columns = 3: must be 8 to"});
  expectRefused(R"({"name": "a", "columns": 900, "elevations_deg": 1})", {"elevations_deg: must be a list"});
  expectRefused(R"({"name": "a", "columns": 900, "elevations_deg": [2, "1"]})",
                {"elevations_deg[1]: must be a number"});
  expectRefused(R"({"name": "a", "columns": 900, "elevations_deg": [1, 1]})", {"elevations_deg = 1", "below"});
  expectRefused(R"({"name": "a", "columns": 900, "elevations_deg": [1, 2]})", {"elevations_deg = 2", "below"});
  expectRefused(R"({"name": "a", "columns": 900, "elevations_deg": [91]})", {"elevations_deg = 91", "between"});
  expectRefused(R"({"name": "a", "columns": 900, "elevations_deg": [1], "rows": 1})", {"rows", "unknown"});
  expectRefused(R"({"name": "a", "columns": 900, "elevations_deg": [1], "source": 1})", {"source: must be a text"});
  expectRefused(R"({"name": "a", "columns": 900, "elevations_deg": [1], "other_names": [1]})",
                {"other_names[0]: must be a text"});
  expectThrows<Error>([&] { readSensorModel(folder.path() / "none.json"); }, {"none.json"});
}

}  // namespace
}  // namespace saw_ndt
