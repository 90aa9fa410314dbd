#include <gtest/gtest.h>

#include "adversarial_clouds.h"
#include "expect_throws.h"
#include "saw_ndt/segmentation/scan_segmenter.h"
#include "saw_ndt/segmentation/sensor_setup.h"

namespace saw_ndt {
namespace {

struct AdversarialSensor {
  const char* sensor;
  GroundRule rule;
  double roll_deg;
};

constexpr AdversarialSensor kSensors[] = {{"VLP-16", GroundRule::GROWING, 0.0},
                                          {"VLP-16", GroundRule::INCLINATION, 0.0},
                                          {"HDL-64E", GroundRule::GROWING, 180.0},
                                          {"VLP-16", GroundRule::GROWING, 90.0},
                                          {"no-rings", GroundRule::GROWING, 0.0}};

SegmentationOptions optionsOf(const AdversarialSensor& sensor) {
  SegmentationOptions options;
  options.sensor = SensorModel::named(sensor.sensor);
  options.ground.rule = sensor.rule;
  options.mounting_roll_deg = sensor.roll_deg;
  return options;
}

TEST(AdversarialScans, HaveALabelAPointAndLeaveNothingBehind) {
  forEveryAdversarialCloud([](const std::vector<LidarPoint>& points) {
    const std::vector<LidarPoint> street = streetScan();
    for (const AdversarialSensor& sensor : kSensors) {
      SCOPED_TRACE(std::string(sensor.sensor) + " " + toString(sensor.rule));
      ScanSegmenter segmenter(optionsOf(sensor)), fresh(optionsOf(sensor));
      std::vector<StructuralLabel> labels, by_threads, after, expected;
      segmenter.segment(viewOf(points), labels);
      ASSERT_EQ(labels.size(), points.size());
      for (std::size_t i = 0; i < points.size(); ++i) {
        ASSERT_LT(static_cast<int>(labels[i]), kStructuralLabelCount);
        const Eigen::Vector3f point = positionOf(points[i]);
        const bool is_none = !point.allFinite() || point.isZero(0.0F);
        ASSERT_TRUE(!is_none || labels[i] == StructuralLabel::NOISE) << i;
      }
      segmenter.segment(viewOf(points), by_threads, 2);
      EXPECT_EQ(by_threads, labels);
      segmenter.segment(viewOf(street), after);
      fresh.segment(viewOf(street), expected);
      EXPECT_EQ(after, expected);
    }
  });
}

TEST(AdversarialScans, TellABelievableSensorOrNone) {
  forEveryAdversarialCloud([](const std::vector<LidarPoint>& points) {
    const LearnedSensor sensor = learnSensor(viewOf(points));
    EXPECT_NO_THROW(sensor.model.check());
    const SegmentationOptions options = optionsOf(kSensors[0]);
    if (const std::optional<LearnedMounting> mounting = learnMounting(viewOf(points))) {
      EXPECT_TRUE(std::isfinite(mounting->height_m));
      EXPECT_NO_THROW(withMounting(options, *mounting, viewOf(points)).check());
    }
    EXPECT_NO_THROW(withSlope(options, {viewOf(points)}).check());
    segmentationDoubts(viewOf(points), options);
  });
}

TEST(AdversarialShapes, RowsAndColumnsThatAreNotThoseOfThePointsAreNotBelieved) {
  const std::vector<LidarPoint> street = streetScan();
  const std::size_t size = street.size() / 16 * 16;
  ScanView plain = viewOf(street);
  plain.size = plain.width = size;
  ScanSegmenter segmenter(optionsOf(kSensors[0]));
  std::vector<StructuralLabel> expected, labels;
  segmenter.segment(plain, expected);
  // The last two times sixteen are the number of points, but for what does not fit 64 bits.
  const std::size_t wrapping = std::size_t{1} << 60;
  for (const auto& [width, height] : {std::pair<std::size_t, std::size_t>{size, 16},
                                      {0, 0},
                                      {0, 16},
                                      {size, 0},
                                      {~std::size_t{0}, ~std::size_t{0}},
                                      {size / 16 + wrapping, 16},
                                      {16, size / 16 + wrapping}}) {
    ScanView odd = plain;
    odd.width = width;
    odd.height = height;
    segmenter.segment(odd, labels);
    EXPECT_EQ(labels, expected) << width << " x " << height;
    learnSensor(odd);
  }
}

TEST(AdversarialBeams, FarPointsAndOnesStraightAboveAreOfNone) {
  // In the order of firing, where elevations alone tell the beams.
  std::vector<LidarPoint> scan = streetScan();
  std::shuffle(scan.begin(), scan.end(), std::mt19937(1));
  const LearnedSensor expected = learnSensor(viewOf(scan));
  EXPECT_EQ(expected.model.name, "VLP-16");
  for (std::size_t i = 0; i < 500; ++i) {
    const auto by = static_cast<float>(i);
    scan.push_back({1e5F, 0.0F, 100.0F * by, 0.5F});
    scan.push_back({0.0F, 0.0F, 5.0F + by, 0.5F});
    scan.push_back({1e30F, by, 1e30F, 0.5F});
  }
  const LearnedSensor learned = learnSensor(viewOf(scan));
  EXPECT_EQ(learned.model.name, expected.model.name);
  EXPECT_EQ(learned.model.elevations_deg, expected.model.elevations_deg);
}

TEST(AdversarialShapes, RingsThatNoSensorHasAreNamed) {
  const std::vector<LidarPoint> street = streetScan();
  ScanSegmenter segmenter(optionsOf(kSensors[0]));
  std::vector<StructuralLabel> labels;
  for (const double ring : {-1.0, 1024.0, 1e300, -1e300, std::nan(""), HUGE_VAL}) {
    std::vector<double> rings(street.size(), 3.0);
    rings[100] = ring;
    ScanView scan = viewOf(street);
    scan.rings = PointField(rings.data());
    expectThrows<std::invalid_argument>([&] { segmenter.segment(scan, labels); }, {"ring", "point 100"});
    learnSensor(scan);
    segmenter.segment(viewOf(street), labels);
    EXPECT_EQ(labels.size(), street.size());
  }
}

}  // namespace
}  // namespace saw_ndt
