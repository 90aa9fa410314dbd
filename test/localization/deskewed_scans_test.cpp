#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cmath>
#include <string>

#include "localization/motion_refinement.h"
#include "real_data.h"
#include "saw_ndt/io/scan_file.h"
#include "saw_ndt/localization/localization_method.h"
#include "saw_ndt/localization/scan_preparation.h"
#include "saw_ndt/map/weighted_map_builder.h"
#include "saw_ndt/registration/ndt_aligner.h"

namespace saw_ndt {

using namespace internal;

namespace {

/// RMS of what is left between two clouds of the same points when one is moved onto the other as a rigid body. The
/// given clouds are in the frame of an IMU, which looks the other way.
double rigidResidual(const std::vector<LidarPoint>& a, const std::vector<LidarPoint>& b) {
  Eigen::Matrix3Xd from(3, a.size()), to(3, a.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    from.col(static_cast<Eigen::Index>(i)) = Eigen::Vector3f(a[i].x, a[i].y, a[i].z).cast<double>();
    to.col(static_cast<Eigen::Index>(i)) = Eigen::Vector3f(b[i].x, b[i].y, b[i].z).cast<double>();
  }
  const Eigen::Isometry3d T(Eigen::umeyama(from, to, false));
  return std::sqrt((T * from - to).colwise().squaredNorm().mean());
}

/// Scans of a LiDAR turned by hand, and what another program made of them with an IMU. They are from different places,
/// and each is registered in a map of its own compensated cloud.
class DeskewedScans : public ::testing::TestWithParam<int> {
 protected:
  static ScanPoints read(const std::string& name) {
    return readScanPoints(realDataFolder() / "sensors" / "deskew" /
                          (name + "_0" + std::to_string(GetParam()) + ".pcd"));
  }
};

TEST_P(DeskewedScans, TheMotionThatRegistrationFindsTakesOutMostOfTheSkew) {
  if (realDataFolder().empty() || !std::filesystem::exists(realDataFolder() / "sensors" / "deskew")) {
    GTEST_SKIP() << "no real scans: set SAW_NDT_DATA to their folder";
  }
  const ScanPoints raw = read("raw"), given = read("deskewed");
  const LocalizationMethod method = LocalizationMethod::named("classical");
  AlignmentOptions alignment;
  alignment.use_weights = false;
  alignment.covariance_scale = method.covariance_scale;
  WeightedMapBuilder builder(0.5);
  builder.addScan(viewOf(given), LabelView(), Eigen::Isometry3d::Identity());
  const NdtTarget target(builder.build(), method.voxels);
  ScanPreparationOptions options;
  options.segment = false;
  options.motion_compensation = MotionCompensation::FROM_TIMES;
  ScanPreparation preparation(options);
  const SourcePoints& source = preparation.prepare(viewOf(raw));

  MovingSource moving;
  moving.take(source, preparation.times_s());
  ASSERT_TRUE(moving.hasTimes());
  MotionPrior prior;
  prior.sigmas << 1.0, 1.0, 1.0, 1.0, 1.0, 1.0;
  Eigen::Isometry3d T_map_lidar = Eigen::Isometry3d::Identity();
  T_map_lidar.linear() = rotationFromVector({0.0, 0.0, kPi});  // the IMU looks the other way
  ScanMotion motion;
  for (int round = 0; round < 3; ++round) {
    T_map_lidar = NdtAligner().align(target, moving.compensatedBy(motion), T_map_lidar, alignment).T_map_source;
    const auto refined = MotionRefinement(alignment).refine(target, moving, T_map_lidar, motion, prior);
    ASSERT_TRUE(refined);
    T_map_lidar = refined->T_map_base;
    motion = refined->motion;
  }
  std::vector<LidarPoint> compensated;
  ASSERT_TRUE(compensateScan(viewOf(raw), MotionCompensation::FROM_TIMES, {}, motion, compensated));
  // The hand did not turn as evenly as the model does.
  RecordProperty("residual_mm", static_cast<int>(std::lround(1000.0 * rigidResidual(compensated, given.points))));
  EXPECT_LT(rigidResidual(compensated, given.points), 0.1);
  EXPECT_GT(rigidResidual(raw.points, given.points), 0.4);
}

INSTANTIATE_TEST_SUITE_P(OfBoth, DeskewedScans, ::testing::Values(0, 1));

}  // namespace
}  // namespace saw_ndt
