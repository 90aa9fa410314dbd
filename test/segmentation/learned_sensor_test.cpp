#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "saw_ndt/segmentation/sensor_setup.h"
#include "segmentation/labelled_scan.h"

namespace saw_ndt {
namespace {

// Elevations differ from those of the beams by at most so much.
constexpr double kNoise_deg = 0.05;

/// Expects the beams of a sensor: of its name, of another with the same beams, or of none.
void expectBeams(const LearnedSensor& learned, const SensorModel& sensor) {
  ASSERT_EQ(learned.model.rows(), sensor.rows()) << learned.model.name;
  for (std::size_t row = 0; row < sensor.elevations_deg.size(); ++row) {
    ASSERT_NEAR(learned.model.elevations_deg[row], sensor.elevations_deg[row], kNoise_deg)
        << learned.model.name << " row " << row;
  }
  // By so much columns may differ before they count as another rate of turning.
  EXPECT_NEAR(learned.model.columns, sensor.columns, 0.25 * sensor.columns);
}

void expectLearned(const ScanView& scan, const SensorModel& sensor, const std::string& evidence) {
  SCOPED_TRACE(sensor.name + " by " + evidence);
  const LearnedSensor learned = learnSensor(scan);
  EXPECT_EQ(learned.evidence, evidence);
  expectBeams(learned, sensor);
}

void expectNoBeams(const LabelledScan& scan) {
  const LearnedSensor learned = learnSensor(viewOf(scan.scan));
  EXPECT_EQ(learned.evidence, "no beams");
  EXPECT_EQ(learned.model.rows(), 0) << learned.model.name;
  EXPECT_NO_THROW(learned.model.check());
}

LabelledScan noisyHall(const SensorModel& sensor, double noise_deg) {
  return scanOf(sensor, hall(), Eigen::Matrix3d::Identity(), noise_deg);
}

/// As the lasers of a Velodyne are numbered: the upper half has the even numbers, the lower one the odd.
int laserOfRow(int row, int rows) {
  const int half = (rows + 1) / 2;
  return row < half ? 2 * row : 2 * (row - half) + 1;
}

double narrowestGap(const SensorModel& sensor) {
  double gap_deg = 90.0;
  for (std::size_t row = 1; row < sensor.elevations_deg.size(); ++row) {
    gap_deg = std::min(gap_deg, sensor.elevations_deg[row - 1] - sensor.elevations_deg[row]);
  }
  return gap_deg;
}

class EverySensor : public ::testing::TestWithParam<std::string> {
 protected:
  const SensorModel sensor = SensorModel::named(GetParam());
};

TEST_P(EverySensor, IsLearnedFromRingsInAnyOrder) {
  // In the order of firing, so that nothing but the rings tells the beams.
  LabelledScan scan = inFiringOrder(noisyHall(sensor, kNoise_deg));
  const std::vector<std::uint16_t> rows = scan.scan.rings;
  const auto renumber = [&](auto ring_of_row) {
    for (std::size_t i = 0; i < rows.size(); ++i) scan.scan.rings[i] = static_cast<std::uint16_t>(ring_of_row(rows[i]));
  };
  expectLearned(viewOf(scan.scan), sensor, "rings");
  renumber([&](int row) { return sensor.rows() - 1 - row; });
  expectLearned(viewOf(scan.scan), sensor, "rings");
  renumber([&](int row) { return laserOfRow(row, sensor.rows()); });
  expectLearned(viewOf(scan.scan), sensor, "rings");
}

TEST_P(EverySensor, IsLearnedFromOrganizedRowsAndColumns) {
  ScanPoints rows = noisyHall(sensor, kNoise_deg).scan;
  rows.rings.clear();
  rows.width = static_cast<std::size_t>(sensor.columns);
  rows.height = static_cast<std::size_t>(sensor.rows());
  ASSERT_EQ(rows.points.size(), rows.width * rows.height) << "in the hall every beam has a return";
  expectLearned(viewOf(rows), sensor, "rows");
  ScanPoints columns = rows;
  for (std::size_t i = 0; i < rows.points.size(); ++i) {
    columns.points[i % rows.width * rows.height + i / rows.width] = rows.points[i];
  }
  std::swap(columns.width, columns.height);
  expectLearned(viewOf(columns), sensor, "rows");
}

TEST_P(EverySensor, IsLearnedFromTheOrderOfRings) {
  // Elevations tell beams that are well apart, the order of points those that noise blurs.
  const LabelledScan sharp = withoutRings(noisyHall(sensor, kNoise_deg));
  expectBeams(learnSensor(viewOf(sharp.scan)), sensor);
  const LabelledScan blurred = withoutRings(noisyHall(sensor, 0.2));
  expectLearned(viewOf(blurred.scan), sensor, "file order");
}

TEST_P(EverySensor, IsLearnedFromElevationsInTheOrderOfFiring) {
  const auto fired = [&](double noise_deg) { return withoutRings(inFiringOrder(noisyHall(sensor, noise_deg))); };
  expectLearned(viewOf(fired(0.01).scan), sensor, "elevations");
  // Noise as wide as the gap between two beams leaves nothing to tell them by; then there are no beams rather than
  // wrong ones.
  constexpr double kBins_deg = 2 * 0.05;
  const LabelledScan noisy = fired(kNoise_deg);
  if (narrowestGap(sensor) > 2 * kNoise_deg + kBins_deg) {
    expectLearned(viewOf(noisy.scan), sensor, "elevations");
  } else {
    expectNoBeams(noisy);
  }
}

std::vector<std::string> sensorsWithBeams() {
  std::vector<std::string> names;
  for (const std::string& name : SensorModel::names()) {
    if (SensorModel::named(name).rows() > 0) names.push_back(name);
  }
  return names;
}

INSTANTIATE_TEST_SUITE_P(LearnSensor, EverySensor, ::testing::ValuesIn(sensorsWithBeams()),
                         [](const ::testing::TestParamInfo<std::string>& tested) {
                           std::string name = tested.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST(LearnSensor, BeamsThatLookAtTheSkyAreNotLost) {
  // Their upper beams see nothing along the street, those of the first three nowhere.
  for (const char* name : {"OS0-128", "QT64", "OS0-32", "OS1-64", "VLP-16", "HDL-32E"}) {
    const SensorModel sensor = SensorModel::named(name);
    const LabelledScan scan = scanOf(sensor, street(), Eigen::Matrix3d::Identity(), kNoise_deg);
    expectLearned(viewOf(scan.scan), sensor, "rings");
    expectLearned(viewOf(withoutRings(scan).scan), sensor, "elevations");
    expectLearned(viewOf(withoutRings(inFiringOrder(scan)).scan), sensor, "elevations");
  }
  // So are those of a sensor of no name.
  const SensorModel other = SensorModel::evenlySpaced("other", 48, 1200, 40.0, -20.0);
  expectLearned(viewOf(scanOf(other, street(), Eigen::Matrix3d::Identity(), kNoise_deg).scan), other, "rings");
}

TEST(LearnSensor, UpsideDownInItsOwnFrameItIsTheSameSensor) {
  for (const char* name : {"HDL-64E", "VLP-32C", "OS1-64"}) {
    const SensorModel sensor = SensorModel::named(name);
    expectLearned(viewOf(scanOf(sensor, street(), levelFromMounting(180.0, 0.0)).scan), sensor, "rings");
  }
}

TEST(LearnSensor, ScansInAFrameThatStandsOnItsHeadHaveBeamsThatDo) {
  LabelledScan scan = scanOf(SensorModel::named("HDL-64E"), street());
  for (LidarPoint& point : scan.scan.points) {
    point.y = -point.y;
    point.z = -point.z;
  }
  for (const LabelledScan& turned : {scan, withoutRings(scan)}) {
    const LearnedSensor learned = learnSensor(viewOf(turned.scan));
    EXPECT_EQ(learned.model.name, "HDL-64E upside down");
    EXPECT_NEAR(learned.model.elevations_deg.front(), -SensorModel::named("HDL-64E").elevations_deg.back(), 1e-9);
  }
}

TEST(LearnSensor, AnotherRateOfTurningIsLearned) {
  SensorModel slow = SensorModel::named("VLP-16");
  slow.columns = 4000;
  const LearnedSensor learned = learnSensor(viewOf(scanOf(slow, street()).scan));
  EXPECT_EQ(learned.model.name, "VLP-16");
  // Some fewer columns than firings, so that jitter leaves none of them empty.
  EXPECT_NEAR(learned.model.columns, 0.864 * 4000, 10.0);
}

TEST(LearnSensor, PointsEverywhereHaveNoBeams) {
  expectNoBeams(scanWithoutBeams(street()));
  expectNoBeams(scanWithoutBeams(hall()));
  expectNoBeams({});
}

/// A cloud of several sensors in the frame of the vehicle: rolled and pitched (deg), and so far ahead (m).
LabelledScan merged(const SensorModel& sensor, const std::vector<Eigen::Vector3d>& mountings) {
  LabelledScan all;
  for (const Eigen::Vector3d& mounting : mountings) {
    const Eigen::Matrix3d R_vehicle_lidar = levelFromMounting(mounting.x(), mounting.y());
    LabelledScan one = scanOf(sensor, street(), R_vehicle_lidar, kNoise_deg);
    for (LidarPoint& point : one.scan.points) {
      const Eigen::Vector3d turned = R_vehicle_lidar * positionOf(point).cast<double>();
      positionOf(point) = (turned + Eigen::Vector3d(mounting.z(), 0.5, 0.0)).cast<float>();
    }
    all.scan.points.insert(all.scan.points.end(), one.scan.points.begin(), one.scan.points.end());
    all.scan.rings.insert(all.scan.rings.end(), one.scan.rings.begin(), one.scan.rings.end());
    all.classes.insert(all.classes.end(), one.classes.begin(), one.classes.end());
  }
  return all;
}

TEST(LearnSensor, MergedCloudsHaveNoBeams) {
  const std::vector<Eigen::Vector3d> level = {{0, 0, 1}, {0, 0, -1}}, sideways = {{20, 0, 1}, {-20, 0, -1}},
                                     forward = {{0, 15, 2}, {0, -15, -2}},
                                     three = {{10, 5, 1}, {-10, 5, -1}, {0, 0, 0}};
  for (const char* name : {"VLP-16", "OS1-64", "HDL-32E"}) {
    SCOPED_TRACE(name);
    for (const auto& mountings : {level, sideways, forward, three}) {
      const LabelledScan scan = merged(SensorModel::named(name), mountings);
      expectNoBeams(withoutRings(scan));
      expectNoBeams(withoutRings(inFiringOrder(scan)));
      // Rings of level sensors go on to have an elevation each.
      if (mountings != level) expectNoBeams(scan);
    }
  }
}

TEST(LearnSensor, RingsThatAreACounterAreNotBelieved) {
  SegmentationOptions options;
  const LabelledScan in_file_order = scanOf(options.sensor, street());
  for (const LabelledScan& scan : {in_file_order, inFiringOrder(in_file_order)}) {
    const std::vector<StructuralLabel> expected = labelsOf(viewOf(withoutRings(scan).scan), options);
    EXPECT_GT(scoreGround(expected, scan.classes).f1(), 0.99);
    LabelledScan counted = scan;
    for (std::size_t i = 0; i < counted.scan.rings.size(); ++i) {
      counted.scan.rings[i] = static_cast<std::uint16_t>(i % 64);
    }
    expectLearned(viewOf(counted.scan), options.sensor, "elevations");
    EXPECT_TRUE(labelsOf(viewOf(counted.scan), options) == expected);
  }
}

TEST(LearnSensor, SeveralScansAreOfWhatMostOfThemShow) {
  const LabelledScan vlp = scanOf(SensorModel::named("VLP-16"), street()), none = scanWithoutBeams(street());
  const ScanView of_vlp = viewOf(vlp.scan), of_none = viewOf(none.scan);
  EXPECT_EQ(learnSensor({of_none, of_vlp, of_vlp}).model.name, "VLP-16");
  EXPECT_EQ(learnSensor({of_none, of_vlp, of_none}).model.rows(), 0);
  EXPECT_EQ(learnSensor({of_vlp, of_none}).model.name, "VLP-16");
}

}  // namespace
}  // namespace saw_ndt
