#include <gtest/gtest.h>
#include <pcl/common/io.h>
#include <pcl/common/transforms.h>
#include <pcl/io/pcd_io.h>

#include <sstream>

#include "apps/run_app_program.h"
#include "registration/registration_fixtures.h"
#include "saw_ndt/common/geometry.h"
#include "temporary_folder.h"

// examples/drop_in.cpp, as it stands and as the program of PCL's NDT, on the same two clouds of a street corner.
namespace saw_ndt {

using namespace internal;

namespace {

Eigen::Isometry3d printedTransform(const AppResult& result) {
  std::istringstream text(result.output);
  Eigen::Isometry3d T;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) text >> T.matrix()(row, column);
  }
  EXPECT_TRUE(text) << "no 4x4 matrix in '" << result.output << "'";
  return T;
}

class DropInExample : public testing::Test {
 protected:
  /// Two scans of the corner, drawn apart, the source moved by the inverse of what is to be found.
  DropInExample() {
    T_target_source_.translation() << 0.30, -0.20, 0.10;
    T_target_source_.linear() = rotationFromVector({0.01, -0.01, 0.04});
    pcl::PointCloud<pcl::PointXYZ> target, source;
    pcl::copyPointCloud(streetCorner(1), target);
    pcl::copyPointCloud(streetCorner(2), source);
    pcl::transformPointCloud(source, source, T_target_source_.inverse().matrix().cast<float>());
    pcl::io::savePCDFileBinary((folder_.path() / "target.pcd").string(), target);
    pcl::io::savePCDFileBinary((folder_.path() / "source.pcd").string(), source);
  }

  AppResult run(const char* program) const {
    return runAppProgram(program,
                         (folder_.path() / "source.pcd").string() + ' ' + (folder_.path() / "target.pcd").string());
  }

  TemporaryFolder folder_;
  Eigen::Isometry3d T_target_source_ = Eigen::Isometry3d::Identity();
};

TEST_F(DropInExample, AgreesWithPclWithinMillimetres) {
  const AppResult ours = run(SAW_NDT_DROP_IN);
  const AppResult theirs = run(SAW_NDT_DROP_IN_PCL);
  EXPECT_EQ(ours.exit_code, 0) << "not converged: " << ours.errors;
  EXPECT_EQ(theirs.exit_code, 0) << theirs.errors;

  const Eigen::Isometry3d apart = printedTransform(ours).inverse() * printedTransform(theirs);
  EXPECT_LT(apart.translation().norm(), 5e-3);
  EXPECT_LT(Eigen::AngleAxisd(apart.rotation()).angle(), 1e-3);
  const Eigen::Isometry3d error = T_target_source_.inverse() * printedTransform(ours);
  EXPECT_LT(error.translation().norm(), 5e-3);
  EXPECT_LT(Eigen::AngleAxisd(error.rotation()).angle(), 1e-3);
}

TEST_F(DropInExample, SaysHowItIsUsed) { EXPECT_EQ(runAppProgram(SAW_NDT_DROP_IN, "").exit_code, 2); }

}  // namespace
}  // namespace saw_ndt
