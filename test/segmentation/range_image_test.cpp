#include "segmentation/range_image.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <stdexcept>

#include "segmentation/synthetic_scan.h"

namespace saw_ndt {

using namespace internal;

namespace {

const float kNan = std::numeric_limits<float>::quiet_NaN();
const float kInfinity = std::numeric_limits<float>::infinity();

// Returns that are missing here and there, so that a row cannot be told by counting.
double patchyRange(int row, int column) { return (row * 7 + column * 13) % 11 < 3 ? kNoReturn : 10.0 + 0.1 * row; }

void expectRowsAndColumns(const RangeImage& image, const SensorModel& sensor, const RangeAt& range_at) {
  std::size_t point = 0;
  for (int row = 0; row < sensor.rows(); ++row) {
    for (int column = 0; column < sensor.columns; ++column) {
      if (!std::isfinite(range_at(row, column))) continue;
      ASSERT_EQ(image.pixelOfPoint()[point], row * sensor.columns + column) << "row " << row << " column " << column;
      ++point;
    }
  }
  EXPECT_EQ(point, image.pixelOfPoint().size());
}

TEST(RangeImage, RecoversRingsFromFileOrderForEverySensor) {
  for (const std::string& name : SensorModel::names()) {
    const SensorModel sensor = SensorModel::named(name);
    if (sensor.rows() == 0) continue;
    const auto cloud = ringOrderedScan(sensor, patchyRange);
    RangeImage image;
    image.project(viewOf(cloud), sensor);
    EXPECT_EQ(image.verticalIndexSource(), VerticalIndexSource::FILE_ORDER) << name;
    expectRowsAndColumns(image, sensor, patchyRange);
  }
}

TEST(RangeImage, RingsWithoutReturnsDoNotShiftTheOthers) {
  const SensorModel sensor = SensorModel::named("VLP-16");
  const auto range_at = [](int row, int column) {
    return row == 0 || row == 7 || row == 8 ? kNoReturn : patchyRange(row, column);
  };
  const auto cloud = ringOrderedScan(sensor, range_at);
  RangeImage image;
  image.project(viewOf(cloud), sensor);
  EXPECT_EQ(image.verticalIndexSource(), VerticalIndexSource::FILE_ORDER);
  expectRowsAndColumns(image, sensor, range_at);
}

TEST(RangeImage, PointRoundedOntoTheSeamStaysInItsRing) {
  const SensorModel sensor = SensorModel::named("VLP-16");
  pcl::PointCloud<pcl::PointXYZ> cloud;
  const auto ring = organizedScan(sensor, [](int, int) { return 10.0; });
  for (std::size_t i = 0; i < ring.size(); ++i) {
    cloud.push_back(ring[i]);
    if (i % ring.width + 1 < ring.width) continue;
    cloud.push_back(ring[i - ring.width + 1]);  // the ring's end, one step past its last point: azimuth 360 is 0
    cloud.back().y = 0.0F;
  }
  RangeImage image;
  image.project(viewOf(cloud), sensor);
  ASSERT_EQ(image.verticalIndexSource(), VerticalIndexSource::FILE_ORDER);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    ASSERT_EQ(image.pixelOfPoint()[i] / sensor.columns, static_cast<int>(i / (ring.width + 1))) << i;
  }
}

TEST(RangeImage, ShuffledPointsFallBackToTheElevationTable) {
  const SensorModel sensor = SensorModel::named("HDL-64E");
  const auto ordered = ringOrderedScan(sensor, patchyRange);
  std::vector<std::size_t> order(ordered.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::shuffle(order.begin(), order.end(), std::mt19937(7));
  pcl::PointCloud<pcl::PointXYZ> shuffled;
  for (const std::size_t i : order) shuffled.push_back(ordered[i]);

  RangeImage image;
  image.project(viewOf(ordered), sensor);
  const std::vector<std::int32_t> expected = image.pixelOfPoint();
  image.project(viewOf(shuffled), sensor);
  EXPECT_EQ(image.verticalIndexSource(), VerticalIndexSource::ELEVATION_TABLE);
  for (std::size_t i = 0; i < order.size(); ++i) ASSERT_EQ(image.pixelOfPoint()[i], expected[order[i]]);
}

TEST(RangeImage, FiringOrderIsNotTakenForRingOrder) {
  const SensorModel sensor = SensorModel::named("HDL-32E");
  const auto organized = organizedScan(sensor, [](int, int) { return 12.0; });
  pcl::PointCloud<pcl::PointXYZ> cloud;
  for (int column = 0; column < sensor.columns; ++column) {
    for (int row = 0; row < sensor.rows(); ++row) cloud.push_back(organized.at(column, row));
  }
  RangeImage image;
  image.project(viewOf(cloud), sensor);
  EXPECT_EQ(image.verticalIndexSource(), VerticalIndexSource::ELEVATION_TABLE);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    ASSERT_EQ(image.pixelOfPoint()[i] / sensor.columns, static_cast<int>(i % sensor.rows()));
  }
}

TEST(RangeImage, TakesRingNumbersFromTopOrBottom) {
  const SensorModel sensor = SensorModel::named("VLP-16");
  const auto cloud = ringOrderedScan(sensor, patchyRange);
  RangeImage image;
  image.project(viewOf(cloud), sensor);
  const std::vector<std::int32_t> expected = image.pixelOfPoint();
  for (const bool from_bottom : {false, true}) {
    std::vector<std::uint16_t> rings;
    for (const std::int32_t pixel : expected) {
      const int row = pixel / sensor.columns;
      rings.push_back(static_cast<std::uint16_t>(from_bottom ? sensor.rows() - 1 - row : row));
    }
    ScanView view = viewOf(cloud);
    view.rings = PointField(rings.data());
    image.project(view, sensor);
    EXPECT_EQ(image.verticalIndexSource(), VerticalIndexSource::RING_FIELD);
    EXPECT_EQ(image.pixelOfPoint(), expected);
    rings.back() = 16;
    EXPECT_THROW(image.project(view, sensor), std::invalid_argument);
  }
}

TEST(RangeImage, TakesTheRowsOfAnOrganizedCloudFromTopOrBottom) {
  const SensorModel sensor = SensorModel::named("OS-64");
  auto cloud = organizedScan(sensor, patchyRange);
  for (const bool upside_down : {false, true}) {
    if (upside_down) std::reverse(cloud.begin(), cloud.end());
    RangeImage image;
    image.project(viewOf(cloud), sensor);
    EXPECT_EQ(image.verticalIndexSource(), VerticalIndexSource::ORGANIZED_ROW);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const auto pixel = static_cast<std::int32_t>(upside_down ? cloud.size() - 1 - i : i);
      ASSERT_EQ(image.pixelOfPoint()[i], std::isfinite(cloud[i].x) ? pixel : RangeImage::kNoPixel);
    }
  }
}

TEST(RangeImage, PointsWithoutRangeHaveNoPixel) {
  const SensorModel sensor = SensorModel::named("VLP-16");
  pcl::PointCloud<pcl::PointXYZ> cloud;
  cloud.push_back(pcl::PointXYZ(kNan, 1.0F, 0.0F));
  cloud.push_back(pcl::PointXYZ(1.0F, kInfinity, 0.0F));
  cloud.push_back(pcl::PointXYZ(1.0F, 0.0F, -kInfinity));
  cloud.push_back(pcl::PointXYZ(0.0F, 0.0F, 0.0F));
  cloud.push_back(pcl::PointXYZ(1e30F, 0.0F, 0.0F));
  cloud.push_back(pcl::PointXYZ(0.0F, 0.0F, 3.0F));
  RangeImage image;
  image.project(viewOf(cloud), sensor);
  for (const std::int32_t pixel : image.pixelOfPoint()) EXPECT_EQ(pixel, RangeImage::kNoPixel);
  EXPECT_EQ(std::count(image.range().begin(), image.range().end(), 0.0F),
            static_cast<std::ptrdiff_t>(image.range().size()));
}

TEST(RangeImage, TheNearestOfSeveralReturnsStandsForThePixel) {
  const SensorModel sensor = SensorModel::evenlySpaced("coarse", 3, 8, 10.0, -10.0);
  pcl::PointCloud<pcl::PointXYZ> cloud;
  for (const float range : {9.0F, 5.0F, 7.0F}) cloud.push_back(pcl::PointXYZ(range, 0.1F * range, 0.0F));
  RangeImage image;
  image.project(viewOf(cloud), sensor);
  EXPECT_EQ(image.pixelOfPoint(), (std::vector<std::int32_t>{8, 8, 8}));
  EXPECT_NEAR(image.range()[8], std::hypot(5.0, 0.5), 1e-5);
}

TEST(RangeImage, AzimuthMatchesTheArcTangent) {
  const SensorModel sensor = SensorModel::evenlySpaced("fine", 1, 16384, 0.0, 0.0);
  pcl::PointCloud<pcl::PointXYZ> cloud;
  for (int i = 0; i < 36000; ++i) {
    const double azimuth = (i + 0.5) * 2.0 * kPi / 36000;
    cloud.push_back(
        pcl::PointXYZ(static_cast<float>(8.0 * std::cos(azimuth)), static_cast<float>(8.0 * std::sin(azimuth)), 0.0F));
  }
  RangeImage image;
  image.project(viewOf(cloud), sensor);
  int differences = 0;
  for (int i = 0; i < 36000; ++i) {
    const int expected = static_cast<int>((i + 0.5) / 36000 * sensor.columns);
    differences += image.pixelOfPoint()[i] == expected ? 0 : 1;
    ASSERT_LE(std::abs(image.pixelOfPoint()[i] - expected), 1);
  }
  EXPECT_LT(differences, 360);  // only points within rounding of a border between columns
}

TEST(RangeImage, LevelsHeightsByTheMountingPitch) {
  const SensorModel sensor = SensorModel::named("VLP-16");
  const double pitch = radiansFromDegrees(5.0);
  // A point level with the sensor, seen by a sensor that looks 5 degrees down, is above its x axis.
  pcl::PointCloud<pcl::PointXYZ> cloud;
  cloud.push_back(
      pcl::PointXYZ(static_cast<float>(10.0 * std::cos(pitch)), 0.01F, static_cast<float>(10.0 * std::sin(pitch))));
  RangeImage image;
  SegmentationOptions options;
  options.mounting_pitch_deg = 5.0;
  image.project(viewOf(cloud), sensor, ScanProjection(options));
  const std::int32_t pixel = image.pixelOfPoint()[0];
  ASSERT_NE(pixel, RangeImage::kNoPixel);
  EXPECT_NEAR(image.height()[pixel], 0.0, 1e-4);
  EXPECT_NEAR(image.horizontalRange()[pixel], 10.0, 1e-4);
}

}  // namespace
}  // namespace saw_ndt
