#include <algorithm>
#include <iostream>

#include "alignment_report.h"
#include "app_options.h"
#include "bin_fields_argument.h"
#include "localization/pose_finder.h"
#include "localization/source_voxel_filter.h"
#include "pose_argument.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/io/point_cloud_file.h"
#include "saw_ndt/pcl/cloud_view.h"
#include "saw_ndt/pcl/weighted_normal_distributions_transform.h"

namespace {

constexpr char kDescription[] =
    "Registers SOURCE to TARGET and prints the transform that moves points of SOURCE onto TARGET. Where both are PCD "
    "files with a label field as saw_ndt_segment writes it, pairs are weighted by labels and structure; otherwise it "
    "is "
    "classical NDT. An alignment that does not converge, or to which too few points fit (-min-overlap), is a failure: "
    "nothing is printed or written. Beside the transform are printed the share of SOURCE that fits (overlap), what "
    "nothing holds (degenerate) and standard deviations, along and about the axes of SOURCE, about its origin or, "
    "where that is more than 100 m away, its middle.";

struct Arguments {
  std::string source_file, target_file, output_file;
  bool classical = false;
  bool global = false;
  bool with_fitness = false;
  bool as_json = false;
  std::vector<double> guess = std::vector<double>(6, 0.0);
  double resolution_m = 1.0;
  std::string neighbors = "direct7";
  std::string optimizer = "damped-newton";
  int max_iterations = saw_ndt::AlignmentOptions().max_iterations;
  double source_voxel_m = 0.0;
  double min_overlap = saw_ndt::AlignmentOptions().min_overlap;
  int bin_fields = 0;
  int threads = 0;
};

bool hasLabels(const std::string& file) {
  const std::vector<std::string> fields = saw_ndt::pointCloudFields(file);
  return std::find(fields.begin(), fields.end(), "label") != fields.end();
}

saw_ndt::NeighborhoodSearchMethod neighborsOf(const std::string& name) {
  using saw_ndt::NeighborhoodSearchMethod;
  if (name == "radius") return NeighborhoodSearchMethod::RADIUS;
  if (name == "direct26") return NeighborhoodSearchMethod::DIRECT26;
  return name == "direct1" ? NeighborhoodSearchMethod::DIRECT1 : NeighborhoodSearchMethod::DIRECT7;
}

template <typename PointT>
typename pcl::PointCloud<PointT>::Ptr readCloud(const std::string& file, int bin_fields) {
  auto cloud = pcl::make_shared<pcl::PointCloud<PointT>>(saw_ndt::readPointCloud<PointT>(file, bin_fields));
  if constexpr (pcl::traits::has_label<PointT>::value) {
    for (std::size_t i = 0; i < cloud->size(); ++i) {
      if ((*cloud)[i].label < saw_ndt::kStructuralLabelCount) continue;
      throw saw_ndt::Error(file, "point " + std::to_string(i),
                           "label " + std::to_string((*cloud)[i].label) +
                               " is none of 0 (noise), 1 (ground), 2 (non-ground); -classical ignores labels");
    }
  }
  return cloud;
}

template <typename PointT>
typename pcl::PointCloud<PointT>::Ptr thinned(const typename pcl::PointCloud<PointT>::Ptr& cloud, double voxel_m) {
  if (voxel_m <= 0.0) return cloud;
  constexpr bool kLabelled = pcl::traits::has_label<PointT>::value;
  std::vector<saw_ndt::StructuralLabel> labels;
  if constexpr (kLabelled) {
    for (const PointT& point : *cloud) labels.push_back(static_cast<saw_ndt::StructuralLabel>(point.label));
  }
  // Voxels reach no farther than 2^19 of them from the origin, and clouds may be in UTM coordinates.
  constexpr float kFar_m = 1.0e4F;
  const auto first = std::find_if(cloud->begin(), cloud->end(), [](const PointT& p) { return pcl::isFinite(p); });
  Eigen::Vector3f origin = Eigen::Vector3f::Zero();
  if (first != cloud->end() && first->getVector3fMap().norm() > kFar_m) origin = first->getVector3fMap();
  saw_ndt::internal::SourceSelection around_origin;
  around_origin.T_base_lidar.translation() = -origin.template cast<double>();
  saw_ndt::internal::SourceVoxelFilter filter(voxel_m);
  const saw_ndt::SourcePoints& points =
      filter.filter(saw_ndt::viewOf(*cloud), kLabelled ? &labels : nullptr, around_origin);
  auto centroids = pcl::make_shared<pcl::PointCloud<PointT>>();
  centroids->resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    (*centroids)[i].getVector3fMap() = origin + Eigen::Vector3f(points.x[i], points.y[i], points.z[i]);
    if constexpr (kLabelled) (*centroids)[i].label = points.label[i];
  }
  return centroids;
}

template <typename PointT>
saw_ndt::SourcePoints sourcePointsOf(const pcl::PointCloud<PointT>& cloud) {
  saw_ndt::SourcePoints source;
  source.labelled = pcl::traits::has_label<PointT>::value;
  for (const PointT& point : cloud) {
    if (!saw_ndt::isWithinReach(point.x, point.y, point.z)) continue;
    saw_ndt::StructuralLabel label = saw_ndt::StructuralLabel::NON_GROUND;
    if constexpr (pcl::traits::has_label<PointT>::value) label = static_cast<saw_ndt::StructuralLabel>(point.label);
    source.add(point.x, point.y, point.z, label);
  }
  return source;
}

// Where SOURCE is found on TARGET when nobody says where to start.
Eigen::Isometry3d searched(const Arguments& arguments, const saw_ndt::NdtTarget& target,
                           const saw_ndt::SourcePoints& source, const saw_ndt::AlignmentOptions& alignment) {
  saw_ndt::LocalizerOptions options;
  options.alignment = alignment;
  options.alignment.evaluate_likelihoods = true;
  constexpr double kShareOfOneScan = 0.05;  // what one scan sees of another is little beside what a map has
  options.global_search.least_share = kShareOfOneScan;
  options.acceptance.min_overlap = arguments.min_overlap;
  options.acceptance.min_overlap_in_doubt = arguments.min_overlap;
  options.acceptance.min_overlap_anywhere = arguments.min_overlap;
  const saw_ndt::internal::PoseAttempt found = saw_ndt::internal::PoseFinder(target, options).findAnywhere(source);
  if (found.accepted()) return found.alignment.T_map_source;
  throw saw_ndt::Error(arguments.source_file, "",
                       "was not found in " + arguments.target_file + ": " + saw_ndt::toString(found.acceptance) +
                           ", overlap " + std::to_string(found.alignment.overlap));
}

template <typename PointT>
void align(const Arguments& arguments) {
  const auto source = readCloud<PointT>(arguments.source_file, arguments.bin_fields);
  const auto target = readCloud<PointT>(arguments.target_file, arguments.bin_fields);
  saw_ndt::WeightedNormalDistributionsTransform<PointT, PointT, double> ndt;
  ndt.setResolution(static_cast<float>(arguments.resolution_m));
  ndt.setNeighborhoodSearchMethod(neighborsOf(arguments.neighbors));
  if (arguments.optimizer == "newton-more-thuente") {
    ndt.setOptimizer(saw_ndt::Optimizer::NEWTON_MORE_THUENTE);
    // As squared metres: steps of a millimetre end the search, as they do for damped-newton.
    ndt.setTransformationEpsilon(1e-6);
  }
  ndt.setMaximumIterations(arguments.max_iterations);
  ndt.setNumberOfThreads(static_cast<unsigned int>(arguments.threads));
  saw_ndt::AlignmentOptions options = ndt.getAlignmentOptions();
  options.min_overlap = arguments.min_overlap;
  ndt.setAlignmentOptions(options);
  ndt.setInputTarget(target);
  ndt.setInputSource(thinned<PointT>(source, arguments.source_voxel_m));
  const Eigen::Isometry3d guess =
      arguments.global ? searched(arguments, ndt.getTargetMap(), sourcePointsOf(*ndt.getInputSource()), options)
                       : saw_ndt::transformOf(arguments.guess);
  pcl::PointCloud<PointT> moved;
  ndt.align(moved, guess.matrix());

  const saw_ndt::AlignmentResult& result = ndt.getAlignmentResult();
  if (!ndt.hasConverged()) {
    throw saw_ndt::Error(arguments.source_file, "",
                         "could not be aligned to " + arguments.target_file + ": " + saw_ndt::toString(result.status) +
                             " after " + std::to_string(result.iterations) + " iterations, overlap " +
                             std::to_string(result.overlap));
  }
  saw_ndt::AlignmentReport report;
  report.result = result;
  report.weighted = pcl::traits::has_label<PointT>::value;
  report.source_points = ndt.getInputSource()->size();
  report.target_voxels = ndt.getTargetMap().voxelCount();
  if (arguments.with_fitness) report.fitness_m2 = ndt.getFitnessScore();
  if (!arguments.output_file.empty()) {
    pcl::transformPointCloud(*source, moved, result.T_map_source.matrix());
    saw_ndt::writePcd(arguments.output_file, moved);
  }
  std::cout << (arguments.as_json ? saw_ndt::toJsonText(report) : saw_ndt::toText(report));
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  saw_ndt::BinFieldsArgument bin_fields;
  saw_ndt::AppOptions app("saw_ndt_align", kDescription);
  app.addPositional("SOURCE", &arguments.source_file, "cloud to move, .pcd, .ply or .bin");
  app.addPositional("TARGET", &arguments.target_file, "cloud to move it onto, .pcd, .ply or .bin");
  app.addPositional("OUT.pcd", &arguments.output_file, "SOURCE in the frame of TARGET, to write", true);
  app.addOption("guess", &arguments.guess, saw_ndt::kPosePlaceholder, "transform to start from, metres and degrees");
  app.addFlag("global", &arguments.global,
              "look for SOURCE in all of TARGET, whatever the heading: both have z up, and labels help");
  app.addOption("resolution", &arguments.resolution_m, "METRES", "edge of a voxel of TARGET");
  app.addChoice("neighbors", &arguments.neighbors, {"radius", "direct26", "direct7", "direct1"},
                "voxels that a point is paired with");
  app.addChoice("optimizer", &arguments.optimizer, {"damped-newton", "newton-more-thuente"},
                "newton-more-thuente is PCL's");
  app.addOption("max-iterations", &arguments.max_iterations, "N", "steps at most");
  app.addOption("source-voxel", &arguments.source_voxel_m, "METRES",
                "thin SOURCE to a centroid a voxel of this edge before it is aligned, 0 for none");
  app.addOption("min-overlap", &arguments.min_overlap, "SHARE",
                "with less of SOURCE beside the ground on surfaces of TARGET there is no answer");
  bin_fields.addTo(app);
  app.addFlag("classical", &arguments.classical, "ignore labels");
  app.addFlag("fitness", &arguments.with_fitness,
              "also tell the mean squared distance (m^2) of the aligned points to their nearest ones in TARGET");
  app.addFlag("json", &arguments.as_json, "print one JSON object");

  return saw_ndt::runApp(argc, argv, app, [&] {
    arguments.threads = app.threads();
    arguments.bin_fields = bin_fields.value();
    if (arguments.global && app.isGiven("guess")) throw saw_ndt::UsageError("option -global: excludes -guess");
    saw_ndt::checkedUsage([&] {
      saw_ndt::checkOption(arguments.resolution_m > 0.0, "resolution", arguments.resolution_m, "positive");
      saw_ndt::checkOption(arguments.max_iterations >= 1, "max-iterations", arguments.max_iterations, "1 or more");
      saw_ndt::checkOption(arguments.source_voxel_m >= 0.0, "source-voxel", arguments.source_voxel_m, "0 or more");
      saw_ndt::checkOption(arguments.min_overlap >= 0.0 && arguments.min_overlap <= 1.0, "min-overlap",
                           arguments.min_overlap, "between 0 and 1");
    });
    const bool labelled = !arguments.classical && hasLabels(arguments.source_file) && hasLabels(arguments.target_file);
    labelled ? align<pcl::PointXYZL>(arguments) : align<pcl::PointXYZ>(arguments);
  });
}
