#include <gtest/gtest.h>

#include <Eigen/SVD>
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

/// RMS of what is left between two clouds of the same points when one is moved onto the other as a rigid body.
double rigidResidual(const std::vector<LidarPoint>& a, const std::vector<LidarPoint>& b) {
  Eigen::Matrix3Xd from(3, a.size()), to(3, a.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    from.col(static_cast<Eigen::Index>(i)) = Eigen::Vector3f(a[i].x, a[i].y, a[i].z).cast<double>();
    to.col(static_cast<Eigen::Index>(i)) = Eigen::Vector3f(b[i].x, b[i].y, b[i].z).cast<double>();
  }
  const Eigen::Isometry3d T(Eigen::umeyama(from, to, false));
  return std::sqrt((T * from - to).colwise().squaredNorm().mean());
}

/// A LiDAR turned by hand: its scans, and what another program made of them. That one gives points in the frame of an
/// IMU, which looks the other way.
class DeskewedScans : public ::testing::TestWithParam<int> {
 protected:
  static ScanPoints read(const std::string& name, int number) {
    return readScanPoints(realDataFolder() / "sensors" / "deskew" / (name + "_0" + std::to_string(number) + ".pcd"));
  }
};

TEST_P(DeskewedScans, TheMotionThatRegistrationFindsTakesOutTheSkew) {
  if (realDataFolder().empty() || !std::filesystem::exists(realDataFolder() / "sensors" / "deskew")) {
    GTEST_SKIP() << "no real scans: set SAW_NDT_DATA to their folder";
  }
  const ScanPoints raw = read("raw", GetParam()), given = read("deskewed", GetParam());
  const ScanPoints other = read("deskewed", 1 - GetParam());
  const LocalizationMethod method = LocalizationMethod::named("classical");
  WeightedMapBuilder builder(0.5);
  builder.addScan(viewOf(other.points), LabelView(), Eigen::Isometry3d::Identity());
  const NdtTarget target(builder.build(), method.voxels);

  ScanPreparationOptions preparation_options;
  preparation_options.segment = false;
  preparation_options.motion_compensation = MotionCompensation::FROM_TIMES;
  ScanPreparation preparation(preparation_options);
  const SourcePoints& source = preparation.prepare(viewOf(raw));
  AlignmentOptions alignment;
  alignment.use_weights = false;
  alignment.covariance_scale = method.covariance_scale;
  Eigen::Isometry3d T_other_lidar = Eigen::Isometry3d::Identity();
  T_other_lidar.linear() = rotationFromVector({0.0, 0.0, kPi});
  const AlignmentResult skewed = NdtAligner().align(target, source, T_other_lidar, alignment);

  MovingSource moving;
  moving.take(source, preparation.times_s());
  ASSERT_TRUE(moving.hasTimes());
  MotionPrior prior;
  prior.sigmas << 2.0, 2.0, 1.0, 0.5, 0.5, 1.0;
  MotionRefinement refinement(target, alignment);
  const auto refined = refinement.refine(moving, skewed.T_map_source, ScanMotion(), prior);
  ASSERT_TRUE(refined);
  EXPECT_TRUE(refined->significant);
  EXPECT_GT(refined->motion.after.turn_rate_radps.norm(), 0.5);

  std::vector<LidarPoint> compensated;
  ASSERT_TRUE(compensateScan(viewOf(raw), MotionCompensation::FROM_TIMES, {}, refined->motion, compensated));
  RecordProperty("residual_mm", static_cast<int>(1000.0 * rigidResidual(compensated, given.points)));
  EXPECT_LT(rigidResidual(compensated, given.points), 0.02);
  EXPECT_GT(rigidResidual(raw.points, given.points), 0.1);
}

INSTANTIATE_TEST_SUITE_P(OfBoth, DeskewedScans, ::testing::Values(0, 1));

}  // namespace
}  // namespace saw_ndt
