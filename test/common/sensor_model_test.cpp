#include "saw_ndt/common/sensor_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

namespace saw_ndt {
namespace {

double leastSpacing(const SensorModel& model) {
  double least = 180.0;
  for (int row = 1; row < model.rows(); ++row) {
    least = std::min(least, model.elevations_deg[row - 1] - model.elevations_deg[row]);
  }
  return least;
}

TEST(SensorModel, NamedModelsAreValidAndHaveTheirBeams) {
  struct Published {
    const char* name;
    int rows, columns;
    double top_deg, bottom_deg, least_spacing_deg;
  };
  const std::vector<Published> all = {
      {"VLP-16", 16, 1800, 15.0, -15.0, 2.0},         {"HDL-32E", 32, 1800, 10.67, -30.67, 1.33},
      {"HDL-64E", 64, 1800, 2.45, -23.66, 0.23},      {"VLP-32C", 32, 1800, 15.0, -25.0, 0.333},
      {"VLS-128", 128, 1800, 15.0, -25.0, 0.11},      {"OS0-32", 32, 1024, 45.0, -45.0, 90.0 / 31},
      {"OS0-64", 64, 1024, 45.0, -45.0, 90.0 / 63},   {"OS0-128", 128, 1024, 45.0, -45.0, 90.0 / 127},
      {"OS1-32", 32, 1024, 22.5, -22.5, 45.0 / 31},   {"OS1-64", 64, 1024, 22.5, -22.5, 45.0 / 63},
      {"OS1-128", 128, 1024, 22.5, -22.5, 45. / 127}, {"OS1-64-gen1", 64, 1024, 16.611, -16.611, 0.527},
      {"OS2-32", 32, 1024, 11.25, -11.25, 22.5 / 31}, {"OS2-64", 64, 1024, 11.25, -11.25, 22.5 / 63},
      {"OS-64", 64, 1024, 22.5, -22.5, 45.0 / 63},    {"OS2-128", 128, 1024, 11.25, -11.25, 22.5 / 127},
      {"OS-128", 128, 1024, 22.5, -22.5, 45.0 / 127}, {"Pandar40P", 40, 1800, 14.882, -24.897, 0.335},
      {"Pandar64", 64, 1800, 14.882, -24.897, 0.162}, {"QT64", 64, 600, 52.133, -52.121, 1.45},
      {"XT32", 32, 2000, 15.0, -16.0, 1.0},           {"AT128", 128, 3600, 12.93, -12.47, 0.2},
      {"RS-16", 16, 1800, 15.0, -15.0, 2.0},          {"RS-32", 32, 1800, 15.0, -25.0, 0.333},
      {"RS-128", 128, 1800, 15.0, -25.0, 0.1},        {"M1", 0, 1800, 0.0, 0.0, 180.0},
      {"no-rings", 0, 1800, 0.0, 0.0, 180.0},
  };
  EXPECT_EQ(SensorModel::names().size(), all.size());
  for (const Published& published : all) {
    const SensorModel model = SensorModel::named(published.name);
    EXPECT_EQ(model.name, published.name);
    EXPECT_NO_THROW(model.check()) << model.name;
    EXPECT_EQ(model.columns, published.columns) << model.name;
    ASSERT_EQ(model.rows(), published.rows) << model.name;
    EXPECT_NEAR(leastSpacing(model), published.least_spacing_deg, 0.0101) << model.name;
    if (model.rows() == 0) continue;
    EXPECT_EQ(model.elevations_deg.front(), published.top_deg) << model.name;
    EXPECT_EQ(model.elevations_deg.back(), published.bottom_deg) << model.name;
  }
}

// Map files state these beams, and are compared with them to the bit.
TEST(SensorModel, BeamsThatMapsAreMadeWithStay) {
  const auto expectEven = [](const char* name, int rows, double top_deg, double bottom_deg) {
    EXPECT_EQ(SensorModel::named(name).elevations_deg,
              SensorModel::evenlySpaced(name, rows, 1024, top_deg, bottom_deg).elevations_deg)
        << name;
  };
  expectEven("VLP-16", 16, 15.0, -15.0);
  expectEven("HDL-32E", 32, 10.67, -30.67);
  expectEven("OS-64", 64, 22.5, -22.5);
  expectEven("OS-128", 128, 22.5, -22.5);
  const std::vector<double> hdl64e = SensorModel::named("HDL-64E").elevations_deg;
  EXPECT_EQ(std::vector<double>(hdl64e.begin() + 30, hdl64e.begin() + 35),
            (std::vector<double>{-7.42, -7.79, -8.39, -8.90, -9.37}));
}

TEST(SensorModel, OtherNamesHaveTheSameBeams) {
  EXPECT_EQ(SensorModel::named("OS-64").elevations_deg, SensorModel::named("OS1-64").elevations_deg);
  EXPECT_EQ(SensorModel::named("OS-128").elevations_deg, SensorModel::named("OS1-128").elevations_deg);
}

TEST(SensorModel, BeamsAreDenseWhereTheMakersSaySo) {
  const auto countBetween = [](const char* name, double bottom_deg, double top_deg) {
    const std::vector<double> beams = SensorModel::named(name).elevations_deg;
    return std::count_if(beams.begin(), beams.end(), [&](double e) { return e >= bottom_deg && e <= top_deg; });
  };
  EXPECT_EQ(countBetween("Pandar64", -6.07, 2.03), 49);   // 0.167 degrees apart
  EXPECT_EQ(countBetween("Pandar40P", -6.07, 2.03), 25);  // 0.33 degrees apart
  EXPECT_EQ(countBetween("VLS-128", -6.51, 4.73), 103);
  EXPECT_EQ(countBetween("RS-128", -6.4, 3.82), 103);
  EXPECT_EQ(countBetween("RS-32", -4.68, 1.68), 20);
}

TEST(SensorModel, TheLowerBlockOfTheHdl64eIsCoarser) {
  const SensorModel model = SensorModel::named("HDL-64E");
  const double upper = (model.elevations_deg[0] - model.elevations_deg[31]) / 31.0;
  const double lower = (model.elevations_deg[32] - model.elevations_deg[63]) / 31.0;
  EXPECT_NEAR(upper, 1.0 / 3.0, 0.02);
  EXPECT_NEAR(lower, 0.5, 0.03);
}

TEST(SensorModel, AnUnknownNameListsTheKnownOnes) {
  try {
    SensorModel::named("HDL-65");
    FAIL();
  } catch (const std::invalid_argument& error) {
    for (const std::string& name : SensorModel::names()) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << name;
    }
  }
}

TEST(SensorModel, StatesAnotherSensor) {
  const SensorModel model = SensorModel::evenlySpaced("mine", 4, 100, 3.0, -6.0);
  EXPECT_EQ(model.elevations_deg, (std::vector<double>{3.0, 0.0, -3.0, -6.0}));
  EXPECT_THROW(SensorModel::evenlySpaced("mine", 4, 100, -6.0, 3.0), std::invalid_argument);
  EXPECT_THROW(SensorModel::evenlySpaced("mine", 0, 100, 3.0, -6.0), std::invalid_argument);
  EXPECT_THROW(SensorModel::evenlySpaced("mine", 4, 0, 3.0, -6.0), std::invalid_argument);
}

}  // namespace
}  // namespace saw_ndt
