#include "drives/prior_sources.h"

#include <gtest/gtest.h>

#include <fstream>
#include <limits>

#include "expect_throws.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"
#include "temporary_folder.h"

namespace saw_ndt {
namespace {

/// Scans without points at given stamps.
class StampedScans : public ScanSource {
 public:
  explicit StampedScans(std::vector<double> stamps_s) : stamps_s_(std::move(stamps_s)) {}
  bool next(RecordedScan& scan) override {
    if (next_ == stamps_s_.size()) return false;
    scan.number = static_cast<int>(next_);
    scan.stamp_s = stamps_s_[next_++];
    return true;
  }
  std::optional<std::size_t> scanCount() const override { return stamps_s_.size(); }

 private:
  std::vector<double> stamps_s_;
  std::size_t next_ = 0;
};

class PriorSources : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& text) const {
    std::ofstream(folder.path() / "file.txt") << text;
    return folder.path() / "file.txt";
  }
  static std::vector<ScanPriors> priorsOf(ScanSource& source) {
    std::vector<ScanPriors> priors;
    RecordedScan scan;
    while (source.next(scan)) priors.push_back(scan.priors);
    return priors;
  }
  std::vector<ScanPriors> odometry(const std::string& text, std::vector<double> stamps_s) const {
    const auto source = withOdometry(std::make_unique<StampedScans>(std::move(stamps_s)), write(text), {0.1, 2.0});
    EXPECT_TRUE(source->scanCount());
    return priorsOf(*source);
  }
  std::vector<ScanPriors> positions(const std::string& text, std::vector<double> stamps_s) const {
    return priorsOf(*withPositions(std::make_unique<StampedScans>(std::move(stamps_s)), write(text), 2.0));
  }

  TemporaryFolder folder;
};

TEST_F(PriorSources, OdometryIsInterpolatedBetweenItsPoses) {
  // From (5, 0) two metres ahead, then a quarter turn to the left on the spot.
  const std::vector<ScanPriors> priors =
      odometry("# comment\n0 5 0 0 0 0 0 1\n0.2 7 0 0 0 0 0 1\n0.4 7 0 0 0 0 0.70710678 0.70710678\n3 8 0 0 0 0 0 1\n",
               {-0.1, 0.0, 0.1, 0.3, 0.4, 1.0, 3.0});
  ASSERT_EQ(priors.size(), 7U);
  EXPECT_FALSE(priors[0].motion);  // before the file
  EXPECT_FALSE(priors[1].motion);  // the scan before has no pose
  ASSERT_TRUE(priors[2].motion);
  EXPECT_NEAR(priors[2].motion->T_before_now.translation().x(), 1.0, 1e-9);
  EXPECT_NEAR(std::sqrt(priors[2].motion->covariance(0, 0)), 0.1, 1e-9);
  EXPECT_NEAR(std::sqrt(priors[2].motion->covariance(5, 5)), radiansFromDegrees(0.2), 1e-9);
  ASSERT_TRUE(priors[3].motion);
  EXPECT_NEAR(priors[3].motion->T_before_now.translation().x(), 1.0, 1e-9);
  EXPECT_NEAR(heading(priors[3].motion->T_before_now), kPi / 4.0, 1e-6);
  ASSERT_TRUE(priors[4].motion);
  EXPECT_NEAR(heading(priors[4].motion->T_before_now), kPi / 4.0, 1e-6);
  EXPECT_FALSE(priors[5].motion);  // in a gap
  EXPECT_FALSE(priors[6].motion);
}

TEST_F(PriorSources, OdometryInCsvHasItsOwnSigmas) {
  const std::vector<ScanPriors> priors = odometry(
      "stamp_s,x_m,y_m,z_m,qx,qy,qz,qw,sigma_m,sigma_deg\n0,0,0,0,0,0,0,1,0,0\n0.1,1,0,0,0,0,0,1,0.3,4\n"
      "0.2,2,0,0,0,0,0,1,0.5,6\n",
      {0.0, 0.2});
  ASSERT_TRUE(priors[1].motion);
  EXPECT_NEAR(priors[1].motion->T_before_now.translation().x(), 2.0, 1e-12);
  EXPECT_NEAR(std::sqrt(priors[1].motion->covariance(1, 1)), 0.8, 1e-9);
  EXPECT_NEAR(std::sqrt(priors[1].motion->covariance(5, 5)), radiansFromDegrees(10.0), 1e-9);
}

TEST_F(PriorSources, AScanGetsTheNearestPosition) {
  const std::string csv = "stamp_s,x_m,y_m,z_m,sigma_x_m,sigma_y_m,sigma_z_m\n1.0,1,2,3,0.5,0.6,0.7\n2.0,4,5,6,1,1,1\n";
  const std::vector<ScanPriors> priors = positions(csv, {0.0, 0.96, 1.04, 1.2, 1.97, 2.5});
  EXPECT_FALSE(priors[0].position);
  for (const std::size_t i : {1U, 2U}) {
    ASSERT_TRUE(priors[i].position);
    EXPECT_EQ(priors[i].position->position_m, Eigen::Vector3d(1, 2, 3));
    EXPECT_NEAR(priors[i].position->covariance(1, 1), 0.36, 1e-12);
  }
  EXPECT_FALSE(priors[3].position);
  EXPECT_EQ(priors[4].position->position_m.x(), 4.0);
  EXPECT_FALSE(priors[5].position);
  EXPECT_NEAR(positions("1,4,5,6\n", {1.0})[0].position->covariance(0, 0), 4.0, 1e-12);
  EXPECT_NEAR(positions("1 4 5 6 0 0 0 1\n", {1.0})[0].position->position_m.z(), 6.0, 1e-12);
}

TEST_F(PriorSources, WhatIsWrongIsNamedWithItsLine) {
  expectThrows<Error>([&] { positions("a,b\n1,2,3\n", {1.0}); }, {"file.txt", "line 2", "3 numbers", "4 or 7"});
  expectThrows<Error>([&] { positions("1,2,3,x\n", {1.0}); }, {"line 1", "'x'"});
  expectThrows<Error>([&] { positions("1,2,3,4,1,0,1\n", {1.0}); }, {"line 1", "sigmas"});
  expectThrows<Error>([&] { positions("stamp,x,y,z\n", {1.0}); }, {"file.txt", "no line"});
  expectThrows<Error>([&] { positions("2,0,0,0\n1,0,0,0\n", {1.0}); }, {"entry 2", "1.0"});
  expectThrows<Error>([&] { odometry("", {1.0}); }, {"file.txt", "no pose"});
  expectThrows<Error>([&] { odometry("1,0,0,0,0,0,0,2,0,0\n", {1.0}); }, {"line 1", "quaternion"});
  expectThrows<Error>([&] { odometry("1 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n", {1.0}); }, {"entry 2"});
  expectThrows<Error>([&] { withPositions(std::make_unique<StampedScans>(std::vector<double>{}), "missing", 1.0); },
                      {"missing"});
  expectThrows<std::invalid_argument>(
      [&] { withPositions(std::make_unique<StampedScans>(std::vector<double>{}), "missing", 0.0); }, {"sigma_m"});
  expectThrows<std::invalid_argument>(
      [&] {
        withOdometry(std::make_unique<StampedScans>(std::vector<double>{}), "missing", {-1.0, 0.5});
      },
      {"share"});
}

}  // namespace
}  // namespace saw_ndt
