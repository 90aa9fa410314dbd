#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "segmentation/labelled_scan.h"

namespace saw_ndt {
namespace {

SensorModel sensor() { return SensorModel::named("OS1-64"); }  // 64 x 1024 beams, 22.5 degrees up and down

struct Mounting {
  double roll_deg, pitch_deg;
};

constexpr Mounting kMountings[] = {{180, 0}, {20, 0}, {-20, 0},  {40, 0}, {0, 20},
                                   {0, -20}, {0, 45}, {180, 20}, {20, 20}};

SegmentationOptions upright() {
  SegmentationOptions options;
  options.sensor = sensor();
  return options;
}

double uprightF1() { return scoreOf(scanOf(sensor(), street()), upright()).f1(); }

TEST(Mounting, TheStreetIsToldUpright) { EXPECT_GT(uprightF1(), 0.99); }

TEST(Mounting, GroundIsToldAsUprightByLearnedOptions) {
  for (const Mounting& mounting : kMountings) {
    const LabelledScan scan = scanOf(sensor(), street(), levelFromMounting(mounting.roll_deg, mounting.pitch_deg));
    const double f1 = scoreOf(scan, learnedOptions(viewOf(scan.scan))).f1();
    EXPECT_NEAR(f1, uprightF1(), 0.01) << mounting.roll_deg << ' ' << mounting.pitch_deg;
  }
}

TEST(Mounting, GroundIsToldAsUprightByStatedOptions) {
  for (const Mounting& mounting : kMountings) {
    const LabelledScan scan = scanOf(sensor(), street(), levelFromMounting(mounting.roll_deg, mounting.pitch_deg));
    SegmentationOptions options = upright();
    options.mounting_roll_deg = mounting.roll_deg;
    options.mounting_pitch_deg = mounting.pitch_deg;
    const double f1 = scoreOf(scan, options).f1();
    EXPECT_NEAR(f1, uprightF1(), 0.01) << mounting.roll_deg << ' ' << mounting.pitch_deg;
  }
}

TEST(Mounting, RampsAreGround) {
  for (const double ramp_deg : {8.0, 12.0, 15.0}) {
    const LabelledScan scan = scanOf(sensor(), street(1.8, ramp_deg));
    const double f1 = scoreOf(scan, learnedOptions(viewOf(scan.scan))).f1();
    SegmentationOptions stated = upright();
    stated.ground.slope_deg = ramp_deg + 1.0;
    EXPECT_GE(f1, 0.97) << ramp_deg;
    EXPECT_GE(scoreOf(scan, stated).f1(), 0.97) << ramp_deg;
  }
}

TEST(Mounting, ARampThatIsSeenMoreDenselyThanTheRoadIsNotTheGroundThatTheSensorStandsOn) {
  // Most of the beams of these look at the horizon, and few at the road around the vehicle.
  for (const auto& [name, ramp_deg] :
       {std::pair("RS-128", 8.0), {"RS-128", 15.0}, {"VLS-128", 12.0}, {"VLP-32C", 15.0}}) {
    const LabelledScan scan = scanOf(SensorModel::named(name), street(1.8, ramp_deg));
    const SegmentationOptions learned = learnedOptions(viewOf(scan.scan));
    EXPECT_EQ(learned.mounting_pitch_deg, 0.0) << name;
    EXPECT_GE(scoreOf(scan, learned).f1(), 0.97) << name << ' ' << ramp_deg;
  }
}

TEST(Mounting, ASensorThatSeesLittleGroundBesideWallsIsFoundUpsideDown) {
  // 7 % of the near returns of this one are of the road.
  const LabelledScan scan = scanOf(SensorModel::named("RS-128"), street(), levelFromMounting(180.0, 0.0));
  const SegmentationOptions learned = learnedOptions(viewOf(scan.scan));
  EXPECT_NEAR(std::abs(learned.mounting_roll_deg), 180.0, 0.5);
  EXPECT_GT(scoreOf(scan, learned).f1(), 0.98);
}

TEST(Mounting, AScanInFiringOrderIsNotTakenForOneLongRing) {
  // Columns of as many points each: points at even distances may all be of one beam.
  for (const Mounting& mounting : {Mounting{0, -20}, Mounting{20, 20}}) {
    SegmentationOptions options;
    options.mounting_roll_deg = mounting.roll_deg;
    options.mounting_pitch_deg = mounting.pitch_deg;
    const LabelledScan rings =
        scanOf(options.sensor, street(), levelFromMounting(mounting.roll_deg, mounting.pitch_deg));
    const double f1 = scoreOf(withoutRings(inFiringOrder(rings)), options).f1();
    EXPECT_NEAR(f1, scoreOf(rings, options).f1(), 0.001) << mounting.roll_deg << ' ' << mounting.pitch_deg;
  }
}

/// Expects points for which `left_out` holds to be noise, and what else there is to be labelled as in a scan that has
/// no such points.
template <typename LeftOut>
void expectLeftOut(const SegmentationOptions& options, const LeftOut& left_out) {
  const LabelledScan scan = scanOf(sensor(), street());
  std::vector<std::size_t> others;
  for (std::size_t i = 0; i < scan.scan.points.size(); ++i) {
    if (!left_out(positionOf(scan.scan.points[i]))) others.push_back(i);
  }
  EXPECT_LT(others.size(), scan.scan.points.size() - 500);
  EXPECT_GT(others.size(), scan.scan.points.size() / 2);
  const std::vector<StructuralLabel> labels = labelsOf(viewOf(scan.scan), options);
  const std::vector<StructuralLabel> expected = labelsOf(viewOf(inOrder(scan, others).scan), upright());
  std::vector<StructuralLabel> all(labels.size(), StructuralLabel::NOISE);
  for (std::size_t k = 0; k < others.size(); ++k) all[others[k]] = expected[k];
  EXPECT_EQ(labels, all);
  // The same on the grid.
  SegmentationOptions on_grid = options, on_grid_without = upright();
  on_grid.sensor = on_grid_without.sensor = SensorModel::named("no-rings");
  const std::vector<StructuralLabel> grid_labels = labelsOf(viewOf(scan.scan), on_grid);
  const std::vector<StructuralLabel> grid_expected = labelsOf(viewOf(inOrder(scan, others).scan), on_grid_without);
  std::fill(all.begin(), all.end(), StructuralLabel::NOISE);
  for (std::size_t k = 0; k < others.size(); ++k) all[others[k]] = grid_expected[k];
  EXPECT_EQ(grid_labels, all);
}

TEST(Mounting, PointsOutOfRangeAreNoneAndChangeNothing) {
  SegmentationOptions options = upright();
  options.min_range_m = 6.0;
  options.max_range_m = 30.0;
  expectLeftOut(options, [](const auto& point) { return !(point.norm() > 6.0F && point.norm() <= 30.0F); });
}

TEST(Mounting, PointsInTheBoxOfTheVehicleAreNoneAndChangeNothing) {
  SegmentationOptions options = upright();
  options.vehicle_box_m = {-8.0, -3.0, -2.5, 6.0, 5.0, 1.0};
  const Eigen::AlignedBox3f box(Eigen::Vector3f(-8, -3, -2.5), Eigen::Vector3f(6, 5, 1));
  expectLeftOut(options, [&](const auto& point) { return box.contains(point); });
}

TEST(Mounting, LabelsDoNotDependOnTheOrderOfRingsAndRows) {
  const SensorModel hall_sensor = sensor();
  const LabelledScan scan = scanOf(hall_sensor, hall());
  for (const double roll_deg : {0.0, 180.0}) {
    const LabelledScan seen = scanOf(hall_sensor, hall(), levelFromMounting(roll_deg, 0.0));
    SegmentationOptions options = upright();
    options.mounting_roll_deg = roll_deg;
    const std::vector<StructuralLabel> expected = labelsOf(viewOf(seen.scan), options);
    EXPECT_GT(std::count(expected.begin(), expected.end(), StructuralLabel::GROUND), 5000);
    EXPECT_EQ(labelsOf(viewOf(withoutRings(seen).scan), options), expected);  // file order
    ScanPoints changed = seen.scan;
    const auto renumber = [&](auto ring_of_row) {
      for (std::size_t i = 0; i < changed.rings.size(); ++i) {
        changed.rings[i] = static_cast<std::uint16_t>(ring_of_row(seen.scan.rings[i]));
      }
    };
    renumber([](int row) { return 63 - row; });
    EXPECT_EQ(labelsOf(viewOf(changed), options), expected) << "from the bottom";
    renumber([](int row) { return row < 32 ? 2 * row : 2 * (row - 32) + 1; });
    EXPECT_EQ(labelsOf(viewOf(changed), options), expected) << "permuted";
    // Rows of an organized scan in the same orders.
    ASSERT_EQ(seen.scan.points.size(), 64U * 1024U);
    for (const bool permuted : {false, true}) {
      std::vector<std::size_t> order;
      for (std::size_t row = 0; row < 64; ++row) {
        const std::size_t from = permuted ? row % 2 * 32 + row / 2 : 63 - row;
        for (std::size_t column = 0; column < 1024; ++column) order.push_back(from * 1024 + column);
      }
      LabelledScan organized = withoutRings(inOrder(seen, order));
      organized.scan.width = 1024;
      organized.scan.height = 64;
      const std::vector<StructuralLabel> labels = labelsOf(viewOf(organized.scan), options);
      for (std::size_t i = 0; i < order.size(); ++i) ASSERT_EQ(labels[i], expected[order[i]]) << permuted << ' ' << i;
    }
  }
}

}  // namespace
}  // namespace saw_ndt
