#include <gtest/gtest.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <cmath>
#include <cstdlib>
#include <future>

#include "drives/velodyne_capture.h"
#include "drives/velodyne_socket.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/drives/kitti_sequence.h"
#include "short_drive.h"
#include "simulation/sequence_writer.h"
#include "temporary_folder.h"

namespace saw_ndt {
namespace {

using internal::openVelodyneCapture;

struct PolarPoint {
  double azimuth_deg;
  double elevation_deg;
  double range_m;
  double intensity;
};

PolarPoint polar(const LidarPoint& point) {
  const double level = std::hypot(point.x, point.y);
  return {std::atan2(point.y, point.x) * 180.0 / kPi, std::atan2(point.z, level) * 180.0 / kPi,
          std::hypot(level, static_cast<double>(point.z)), point.intensity};
}

/// Points of each beam of a VLP-16, the lowest first, by azimuth.
std::vector<std::vector<PolarPoint>> beamsOf(const std::vector<LidarPoint>& points) {
  std::vector<std::vector<PolarPoint>> beams(16);
  for (const LidarPoint& point : points) {
    const PolarPoint one = polar(point);
    beams.at(static_cast<std::size_t>(std::lround((one.elevation_deg + 15.0) / 2.0))).push_back(one);
  }
  for (auto& beam : beams) {
    std::sort(beam.begin(), beam.end(),
              [](const PolarPoint& a, const PolarPoint& b) { return a.azimuth_deg < b.azimuth_deg; });
  }
  return beams;
}

double azimuthBetween(const PolarPoint& a, const PolarPoint& b) {
  return std::abs(std::remainder(a.azimuth_deg - b.azimuth_deg, 360.0));
}

/// The point of a beam whose azimuth is nearest.
const PolarPoint& nearestOf(const std::vector<PolarPoint>& beam, const PolarPoint& point) {
  const auto after = std::lower_bound(beam.begin(), beam.end(), point, [](const PolarPoint& a, const PolarPoint& b) {
    return a.azimuth_deg < b.azimuth_deg;
  });
  const PolarPoint& next = after == beam.end() ? beam.front() : *after;
  const PolarPoint& last = after == beam.begin() ? beam.back() : *(after - 1);
  return azimuthBetween(next, point) < azimuthBetween(last, point) ? next : last;
}

class SimulatedCapture : public ::testing::Test {
 protected:
  static constexpr int kScans = 3;
  static constexpr double kBegin_s = 1.6e9;

  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder();
    const SimulatedDrive drive = shortDrive("residential", {}, kScans);
    LidarSimulator simulator(drive.scene, LidarOptions::named("VLP-16"));
    writeSequence(folder_->path(), simulator, *drive.motion);
  }
  static void TearDownTestSuite() { delete folder_; }

  static std::unique_ptr<Recording> capture(const std::string& options) {
    const std::string path = (folder_->path() / "drive.pcap").string();
    const std::string command =
        std::string("python3 " SAW_NDT_SOURCE_DIR "/test/recordings/write_velodyne_capture.py ") +
        folder_->path().string() + " " + path + " " + options;
    if (std::system(command.c_str()) != 0) return nullptr;
    return openVelodyneCapture(path);
  }

  static inline TemporaryFolder* folder_ = nullptr;
};

TEST_F(SimulatedCapture, GivesThePointsBackWhereEachHasAFiring) {
  const auto drive = capture("--exact");
  ASSERT_TRUE(drive);
  const KittiSequence sequence(folder_->path());
  ASSERT_EQ(drive->scanCount(), kScans);
  for (int number = 0; number < kScans; ++number) {
    EXPECT_NEAR(drive->stamps()[static_cast<std::size_t>(number)],
                kBegin_s + sequence.stamps()[static_cast<std::size_t>(number)], 1e-6);
    ScanPoints scan;
    drive->readScan(number, scan);
    const std::vector<LidarPoint> truth = sequence.readScan(number);
    ASSERT_EQ(scan.points.size(), truth.size());
    const auto beams = beamsOf(truth);
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      const PolarPoint point = polar(scan.points[i]);
      const PolarPoint& true_point = nearestOf(beams.at(scan.rings[i]), point);
      ASSERT_LE(azimuthBetween(point, true_point), 0.0101);
      ASSERT_NEAR(point.range_m, true_point.range_m, 0.00101);
      ASSERT_NEAR(point.elevation_deg, true_point.elevation_deg, 0.035);  // the simulator's jitter
      ASSERT_NEAR(point.intensity, 255.0 * true_point.intensity, 0.51);
    }
  }
}

TEST_F(SimulatedCapture, LooksLikeTheDriveWhereFiringsAreTheSensors) {
  const auto drive = capture("");
  ASSERT_TRUE(drive);
  const KittiSequence sequence(folder_->path());
  ASSERT_EQ(drive->scanCount(), kScans);
  for (int number = 0; number < kScans; ++number) {
    const double stamp_s = drive->stamps()[static_cast<std::size_t>(number)];
    EXPECT_NEAR(stamp_s, kBegin_s + sequence.stamps()[static_cast<std::size_t>(number)], 6e-5);
    ScanPoints scan;
    drive->readScan(number, scan);
    const std::vector<LidarPoint> truth = sequence.readScan(number);
    EXPECT_NEAR(static_cast<double>(scan.points.size()), static_cast<double>(truth.size()),
                0.02 * static_cast<double>(truth.size()));
    const auto beams = beamsOf(truth);
    std::size_t near = 0;
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      const PolarPoint point = polar(scan.points[i]);
      const PolarPoint& true_point = nearestOf(beams.at(scan.rings[i]), point);
      ASSERT_LE(azimuthBetween(point, true_point), 0.2);
      near += std::abs(point.range_m - true_point.range_m) < 0.05 ? 1 : 0;
      // Clockwise from x at the stamp.
      const double turn = std::remainder(-point.azimuth_deg / 360.0 - (scan.times_s[i] - stamp_s) / 0.1, 1.0);
      ASSERT_NEAR(turn, 0.0, 7e-4);
    }
    EXPECT_GT(static_cast<double>(near), 0.9 * static_cast<double>(scan.points.size()));
  }
}

TEST_F(SimulatedCapture, HasEvenStampsWhereTheNetworkIsLateAndTheSensorWithoutGps) {
  const auto drive = capture("--jitter 0.01 --sensor-clock 1999.5");
  ASSERT_TRUE(drive);
  ASSERT_EQ(drive->scanCount(), kScans);
  for (int number = 1; number < kScans; ++number) {
    EXPECT_NEAR(drive->stamps()[static_cast<std::size_t>(number)], kBegin_s + 0.1 * number, 1e-3);
  }
}

TEST_F(SimulatedCapture, IsTheSameWhereItIsReplayedToALiveSource) {
  const auto drive = capture("");
  ASSERT_TRUE(drive);
  boost::asio::io_context context;
  boost::asio::ip::udp::socket any_free(context, {boost::asio::ip::make_address("127.0.0.1"), 0});
  const std::uint16_t port = any_free.local_endpoint().port();
  any_free.close();
  const auto source = internal::listenToVelodyne("127.0.0.1", port);
  const auto replaying = std::async(std::launch::async, [&] {
    const std::string command = std::string("python3 " SAW_NDT_SOURCE_DIR "/test/recordings/replay_capture.py ") +
                                drive->path().string() + " " + std::to_string(port);
    if (std::system(command.c_str()) != 0) source->stop();
  });
  RecordedScan live;
  ScanPoints captured;
  // The last scan ends with the capture, which a live source does not know of.
  for (int number = 0; number + 1 < kScans; ++number) {
    if (!source->next(live)) break;
    drive->readScan(number, captured);
    EXPECT_EQ(live.number, number);
    EXPECT_EQ(live.rings, captured.rings);
    ASSERT_EQ(live.points.size(), captured.points.size());
    const double apart_s = live.stamp_s - drive->stamps()[static_cast<std::size_t>(number)];
    for (std::size_t i = 0; i < live.points.size(); ++i) {
      ASSERT_EQ(positionOf(live.points[i]), positionOf(captured.points[i]));
      ASSERT_NEAR(live.times_s[i] - captured.times_s[i], apart_s, 1e-6);
    }
  }
  replaying.wait();
  EXPECT_EQ(source->leftOut(), 0U);
  EXPECT_EQ(source->rejected(), 0U);
  EXPECT_EQ(live.number, kScans - 2);
}

}  // namespace
}  // namespace saw_ndt
