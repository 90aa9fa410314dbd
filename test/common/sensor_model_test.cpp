#include "saw_ndt/common/sensor_model.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace saw_ndt {
namespace {

TEST(SensorModel, NamedModelsAreValidAndHaveTheirBeams) {
  for (const std::string& name : SensorModel::names()) EXPECT_NO_THROW(SensorModel::named(name).check()) << name;
  EXPECT_EQ(SensorModel::named("HDL-64E").rows(), 64);
  EXPECT_EQ(SensorModel::named("HDL-64E").columns, 1800);
  EXPECT_EQ(SensorModel::named("HDL-32E").rows(), 32);
  EXPECT_EQ(SensorModel::named("VLP-16").rows(), 16);
  EXPECT_EQ(SensorModel::named("OS-64").rows(), 64);
  EXPECT_EQ(SensorModel::named("OS-128").rows(), 128);
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
