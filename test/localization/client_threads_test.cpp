#include <gtest/gtest.h>
#include <omp.h>

#include <functional>
#include <thread>
#include <vector>

#include "adversarial_clouds.h"
#include "registration/registration_fixtures.h"
#include "saw_ndt/localization/global_search.h"
#include "saw_ndt/localization/localizer.h"
#include "saw_ndt/map/moved_voxels.h"
#include "saw_ndt/pcl/range_image_segmentation.h"
#include "saw_ndt/pcl/weighted_normal_distributions_transform.h"
#include "saw_ndt/registration/ndt_aligner.h"
#include "saw_ndt/registration/pose_scorer.h"
#include "saw_ndt/segmentation/scan_segmenter.h"

// A program may call this library from any threads of its own: each has its own segmenters, aligners and localizers,
// and shares maps, targets and searches. All results are those of one thread, bit for bit.
namespace saw_ndt {
namespace {

constexpr int kClients = 4;
constexpr int kRounds = 2;

/// How clients run at the same time.
using RunClients = void (*)(const std::function<void(int client)>& work);

void inThreads(const std::function<void(int)>& work) {
  std::vector<std::thread> threads;
  for (int client = 0; client < kClients; ++client) threads.emplace_back(work, client);
  for (std::thread& thread : threads) thread.join();
}

void inAnOpenMpRegion(const std::function<void(int)>& work) {
#pragma omp parallel for num_threads(kClients) schedule(static, 1)
  for (int client = 0; client < kClients; ++client) work(client);
}

class ClientThreads : public testing::TestWithParam<RunClients> {
 protected:
  /// Expects that a client gets the same results beside others as alone.
  template <typename Work>
  void expectTheSameBesideOthers(const Work& work) const {
    using Result = decltype(work(0));
    std::vector<Result> alone, beside(kClients);
    for (int client = 0; client < kClients; ++client) alone.push_back(work(client));
    for (int round = 0; round < kRounds; ++round) {
      GetParam()([&](int client) { beside[static_cast<std::size_t>(client)] = work(client); });
      for (std::size_t client = 0; client < kClients; ++client) EXPECT_TRUE(beside[client] == alone[client]) << client;
    }
  }
};

std::vector<double> valuesOf(const AlignmentResult& result) {
  std::vector<double> values(result.T_map_source.data(), result.T_map_source.data() + 16);
  values.insert(values.end(), result.covariance.data(), result.covariance.data() + 36);
  values.insert(values.end(), {result.score, result.overlap, result.likelihoods.unweighted});
  return values;
}

Eigen::Isometry3d guessOf(int client) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << 0.1 * client - 0.15, 0.1, 0.05;
  return T;
}

TEST_P(ClientThreads, SegmentScans) {
  expectTheSameBesideOthers([](int client) {
    SegmentationOptions options;
    options.sensor = SensorModel::named("VLP-16");
    ScanSegmenter segmenter(options);
    std::vector<StructuralLabel> labels;
    segmenter.segment(viewOf(streetScan(static_cast<unsigned>(client))), labels, 2);
    return labels;
  });
}

TEST_P(ClientThreads, AlignToOneTarget) {
  const NdtTarget target = exactTargetOf(streetCorner(1, 1000));
  const SourcePoints source = sourceOf(streetCorner(2, 200));
  expectTheSameBesideOthers([&](int client) {
    AlignmentOptions options;
    options.threads = 2;
    options.evaluate_likelihoods = true;
    if (client == 1) options.optimizer = Optimizer::NEWTON_MORE_THUENTE;
    if (client == 2) options.arithmetic = Arithmetic::DOUBLE;
    return valuesOf(NdtAligner().align(target, source, guessOf(client), options));
  });
}

TEST_P(ClientThreads, AlignCopiesOfOneDropIn) {
  using Ndt = WeightedNormalDistributionsTransform<pcl::PointXYZL, pcl::PointXYZL>;
  Ndt original;
  original.setNumberOfThreads(2);
  original.setInputTarget(pcl::make_shared<pcl::PointCloud<pcl::PointXYZL>>(streetCorner(1, 1000)));
  original.setInputSource(pcl::make_shared<pcl::PointCloud<pcl::PointXYZL>>(streetCorner(2, 200)));
  pcl::PointCloud<pcl::PointXYZL> output_of_original;
  original.align(output_of_original);
  std::vector<Ndt> copies(kClients, original);
  expectTheSameBesideOthers([&](int client) {
    Ndt& copy = copies[static_cast<std::size_t>(client)];
    copy.setInputSource(pcl::make_shared<pcl::PointCloud<pcl::PointXYZL>>(streetCorner(2, 100 + 50 * client)));
    pcl::PointCloud<pcl::PointXYZL> output;
    copy.align(output, guessOf(client).matrix().cast<float>());
    std::vector<double> values = valuesOf(copy.getAlignmentResult());
    values.push_back(copy.getFitnessScore());
    return values;
  });
}

TEST_P(ClientThreads, ScorePosesAndSearchOneMap) {
  const NdtTarget target = exactTargetOf(streetCorner(1, 1000));
  const GlobalSearch search(target);
  const SourcePoints source = sourceOf(streetCorner(2, 200));
  expectTheSameBesideOthers([&](int client) {
    std::vector<double> values;
    PoseScorer scorer(target, source);
    for (const Likelihoods& likelihoods : scorer.score({guessOf(client), guessOf(client + 1)}, 2)) {
      values.push_back(likelihoods.unweighted);
    }
    for (const PoseCandidate& candidate : search.candidates(source, std::nullopt, 2)) {
      values.push_back(candidate.matched_share);
      values.insert(values.end(), candidate.T_map_base.data(), candidate.T_map_base.data() + 16);
    }
    return values;
  });
}

TEST_P(ClientThreads, BuildMaps) {
  expectTheSameBesideOthers([](int client) {
    WeightedMapBuilder builder(1.0);
    const std::vector<LidarPoint> street = streetScan(static_cast<unsigned>(client));
    // Enough for several parts.
    std::vector<LidarPoint> dense;
    for (int i = 0; i < 12; ++i) dense.insert(dense.end(), street.begin(), street.end());
    builder.addScan(viewOf(dense), {}, guessOf(client), 2);
    const NdtTarget target(builder.build(), {}, 2);
    std::vector<double> values;
    for (const Eigen::Vector3d& mean : target.means()) values.insert(values.end(), mean.data(), mean.data() + 3);
    return values;
  });
}

TEST_P(ClientThreads, ReadOneMapAndCountWhatMovedInOne) {
  WeightedMapBuilder builder(1.0);
  builder.addScan(viewOf(streetScan()), {}, Eigen::Isometry3d::Identity());
  const WeightedVoxelMap map = builder.build();
  expectTheSameBesideOthers([&](int client) {
    VoxelWeighting weighting;
    weighting.min_points_per_voxel = 3 + client;
    return map.voxelCount(weighting, 2) + (map.find({3.0, 5.0, 0.0}, weighting) ? 1 : 0);
  });
  const auto countedBy = [&](const auto& run) {
    MovedVoxels moved(map);
    run([&](int client) { moved.addScan(viewOf(streetScan(static_cast<unsigned>(client))), guessOf(client)); });
    return moved.remaining().origin().point_count;
  };
  const std::uint64_t expected = countedBy([](const auto& work) {
    for (int client = 0; client < kClients; ++client) work(client);
  });
  EXPECT_EQ(countedBy(GetParam()), expected);
}

TEST_P(ClientThreads, LocalizeInOneTarget) {
  LocalizerOptions options;
  options.method = LocalizationMethod::named("classical");
  options.alignment.threads = 2;
  WeightedMapBuilder builder(0.5);
  for (const unsigned seed : {1U, 2U, 3U}) builder.addScan(viewOf(streetScan(seed)), {}, Eigen::Isometry3d::Identity());
  const NdtTarget target(builder.build(), options.method.voxels);
  expectTheSameBesideOthers([&](int client) {
    Localizer localizer(target, options);
    localizer.setInitialPose(guessOf(client));
    std::vector<double> values;
    for (int scan = 0; scan < 3; ++scan) {
      const LocalizationResult result =
          localizer.localize(viewOf(streetScan(static_cast<unsigned>(10 + client + scan))), 0.1 * scan);
      values.push_back(result.accepted() ? 1.0 : 0.0);
      values.insert(values.end(), result.T_map_base.data(), result.T_map_base.data() + 16);
      values.insert(values.end(), result.covariance.data(), result.covariance.data() + 36);
    }
    return values;
  });
}

INSTANTIATE_TEST_SUITE_P(Of, ClientThreads, testing::Values(&inThreads, &inAnOpenMpRegion),
                         [](const auto& of) { return std::string(of.index == 0 ? "Threads" : "OpenMp"); });

}  // namespace
}  // namespace saw_ndt
