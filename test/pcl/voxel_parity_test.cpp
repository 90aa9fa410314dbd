#include <gtest/gtest.h>
#include <pcl/filters/voxel_grid_covariance.h>

#include "map/map_fixtures.h"
#include "real_data.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/drives/kitti_sequence.h"

namespace saw_ndt {

using namespace internal;

namespace {

/// Builds both grids of 1 m voxels: at 1 m PCL's single-precision product coordinate * (1 / leaf size) is exact, so
/// that no point near a face falls on the other side. Both keep voxels of 6 points or more.
void expectParity(const pcl::PointCloud<pcl::PointXYZ>::ConstPtr& cloud, std::size_t fewest_voxels) {
  const WeightedVoxelMap map = mapOf(*cloud);
  pcl::VoxelGridCovariance<pcl::PointXYZ> grid;
  grid.setInputCloud(cloud);
  grid.setLeafSize(1.0F, 1.0F, 1.0F);
  ASSERT_EQ(grid.getMinPointPerVoxel(), VoxelWeighting().min_points_per_voxel);
  ASSERT_EQ(grid.getCovEigValueInflationRatio(), VoxelWeighting().min_eigenvalue_ratio);
  grid.filter(true);

  std::size_t voxel_count = 0;
  for (const auto& [index, leaf] : grid.getLeaves()) voxel_count += leaf.nr_points >= 6 ? 1 : 0;
  const std::vector<VoxelStatistics> voxels = map.statistics();
  EXPECT_EQ(voxels.size(), voxel_count);
  EXPECT_GE(voxel_count, fewest_voxels);

  // Points are rounded by h = half a step: 7.6 micrometres. That moves a mean by h at most. A deviation from the mean
  // moves by 2 h at most, so an element of the sample covariance by 2 h (sigma_i + sigma_j) sqrt(N / (N - 1)) and a
  // term in h^2, where no sigma exceeds 0.5 m sqrt(N / (N - 1)): 2 h 1.2 in all. Raising eigenvalues does not stretch
  // a change of the matrix by more than its Frobenius norm, three times that of an element. Rounding errors of many
  // points mostly cancel: the mean change of an element must be ten times less than that bound.
  const double h = 0.5 / kStepsPerVoxel;
  const double bound = 3.0 * 2.0 * h * 1.2;
  double change_sum = 0.0;
  for (const VoxelStatistics& voxel : voxels) {
    Eigen::Vector3f centre = (voxel.voxel.cast<float>().array() + 0.5F).matrix();
    const auto* leaf = grid.getLeaf(centre);
    ASSERT_NE(leaf, nullptr) << voxel.voxel.transpose();
    ASSERT_EQ(static_cast<std::uint64_t>(leaf->nr_points), voxel.point_count);
    ASSERT_LE((leaf->getMean() - voxel.mean(1.0)).cwiseAbs().maxCoeff(), h + 1e-9);
    const double change = (leaf->getCov() - voxel.covariance).cwiseAbs().maxCoeff();
    ASSERT_LE(change, bound) << "PCL\n" << leaf->getCov() << "\nours\n" << voxel.covariance;
    change_sum += change;
  }
  EXPECT_LT(change_sum / static_cast<double>(voxel_count), 0.1 * bound);
}

TEST(PclParity, OfASyntheticCloud) {
  const auto cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZ>>(withoutLabels(mixedCloud(1, 8000)));
  expectParity(cloud, 100);
}

TEST(PclParity, OfRealScans) {
  const std::filesystem::path data = realDataFolder();
  if (data.empty()) GTEST_SKIP() << "no real scans: set SAW_NDT_DATA to their folder";
  const KittiSequence sequence(data / "kitti" / "sequences" / "drive_0005");
  const std::vector<Eigen::Isometry3d> poses = sequence.posesLidar();
  const auto cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  for (const int scan : {0, 2, 4}) {
    for (const LidarPoint& point : sequence.readScan(scan)) {
      const Eigen::Vector3f p_map =
          (poses[static_cast<std::size_t>(scan)] * positionOf(point).cast<double>()).cast<float>();
      cloud->push_back({p_map.x(), p_map.y(), p_map.z()});
    }
  }
  expectParity(cloud, 3000);
}

}  // namespace
}  // namespace saw_ndt
