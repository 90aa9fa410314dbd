#include "saw_ndt/drives/map_import.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "common/middle_value.h"
#include "common/no_return.h"
#include "drives/cloud_map_files.h"
#include "drives/ground_heights.h"
#include "io/cloud_blocks.h"
#include "io/pcd_fields.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt {

namespace {

using namespace internal;
namespace fs = std::filesystem;

constexpr float kFarCoordinate_m = 1e5F;
constexpr double kOriginStep_m = 1000.0;
constexpr std::size_t kFirstPoints = 1000;  // that tell where a cloud lies
constexpr float kNotFinite = std::numeric_limits<float>::quiet_NaN();

bool isFinite(const LidarPoint& point) {
  return std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z);
}

/// The origin near the first points of clouds that lie far out.
std::array<double, 3> originNearFirstPoints(const std::vector<fs::path>& files) {
  PcdCloud block;
  for (const fs::path& file : files) {
    for (CloudBlocks blocks(file, kFirstPoints); blocks.next(block);) {
      std::array<std::vector<float>, 3> coordinates;
      for (const LidarPoint& point : pointsOf(file, block)) {
        if (!isFinite(point) || !isReturn(&point.x)) continue;
        coordinates[0].push_back(point.x);
        coordinates[1].push_back(point.y);
        coordinates[2].push_back(point.z);
      }
      if (coordinates[0].empty()) continue;
      std::array<double, 3> origin_m{};
      const std::array<float, 3> middle = {middleValue(coordinates[0]), middleValue(coordinates[1]),
                                           middleValue(coordinates[2])};
      const bool far_out = std::abs(middle[0]) > kFarCoordinate_m || std::abs(middle[1]) > kFarCoordinate_m;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (std::abs(middle[axis]) > kFarCoordinate_m || (far_out && axis < 2)) {
          origin_m[axis] = kOriginStep_m * std::round(middle[axis] / kOriginStep_m) + 0.0;  // no -0
        }
      }
      return origin_m;
    }
  }
  return {};
}

/// Labels of the points of a block. Returns why there are none, empty where there are.
using TellLabels =
    std::function<std::string(const fs::path& file, const PcdCloud& cloud, const std::vector<LidarPoint>& points,
                              std::vector<StructuralLabel>& labels)>;

std::string labelsOfFile(const fs::path& file, const PcdCloud& cloud, const std::vector<LidarPoint>& /*points*/,
                         std::vector<StructuralLabel>& labels) {
  const PcdColumn* column = cloud.find({"label"});
  if (column == nullptr) return file.string() + " has no field label";
  bool known = true;
  labels.resize(cloud.points);
  cloud.forEach(*column, [&](std::size_t point, double number) {
    const auto label = static_cast<StructuralLabel>(number >= 0.0 && number < kStructuralLabelCount ? number : 0.0);
    known = known && static_cast<double>(label) == number;
    labels[point] = label;
  });
  return known ? "" : file.string() + " has labels other than 0 (noise), 1 (ground) and 2 (non-ground)";
}

class Importer {
 public:
  Importer(const fs::path& cloud, const MapImportOptions& options)
      : cloud_(cloud), options_(options), files_(cloudMapFiles(cloud)) {}

  ImportedMap run() {
    const std::array<double, 3> origin_m = options_.origin_m ? *options_.origin_m : originNearFirstPoints(files_.files);
    std::string why_unlabelled;
    if (options_.labels == ImportedLabels::AUTO) {
      start(origin_m);
      why_unlabelled = addAll(labelsOfFile);
      if (why_unlabelled.empty() && !labels_say_something_) why_unlabelled = "all labels are 0 (noise)";
      if (why_unlabelled.empty()) return finished();
    }
    start(origin_m);
    map_->why_unlabelled = why_unlabelled;
    if (options_.labels == ImportedLabels::HEIGHTS) {
      addWithHeights();
    } else {
      addAll({});
    }
    return finished();
  }

 private:
  void start(const std::array<double, 3>& origin_m) {
    map_.emplace(ImportedMap{WeightedMapBuilder(options_.resolution_m), origin_m, 0, 0, 0, 0, {}, {}});
    map_->files_beside = files_.beside;
    map_->files = files_.files.size();
  }

  ImportedMap finished() {
    if (map_->builder.origin().point_count == 0) {
      throw Error(cloud_.string(), "",
                  "holds no point for a map: none of " + std::to_string(map_->points_read) +
                      " is finite, not (0, 0, 0) and within reach");
    }
    map_->builder.setMapOrigin(Eigen::Vector3d(map_->origin_m.data()));
    return std::move(*map_);
  }

  /// Calls take(file, cloud, points) for every block; (0, 0, 0) becomes NaN. Ends where a reason is returned, and
  /// returns it.
  template <typename Take>
  std::string forEachBlock(const Take& take) {
    map_->points_read = map_->points_not_finite = map_->points_at_zero = 0;
    LidarPoint zero;  // where (0, 0, 0) of the cloud is, once the origin has been taken off
    zero.x = static_cast<float>(-map_->origin_m[0]);
    zero.y = static_cast<float>(-map_->origin_m[1]);
    zero.z = static_cast<float>(-map_->origin_m[2]);
    PcdCloud block;
    for (const fs::path& file : files_.files) {
      for (CloudBlocks blocks(file, options_.block_points); blocks.next(block);) {
        std::vector<LidarPoint> points = pointsOf(file, block, map_->origin_m);
        for (LidarPoint& point : points) {
          if (!isFinite(point)) {
            ++map_->points_not_finite;
          } else if (point.x == zero.x && point.y == zero.y && point.z == zero.z) {
            ++map_->points_at_zero;
            point.x = point.y = point.z = kNotFinite;
          }
        }
        map_->points_read += points.size();
        const std::string reason = take(file, block, points);
        if (!reason.empty()) return reason;
      }
    }
    return "";
  }

  /// Adds all points, without labels where nothing tells them. Returns why there are none, with the work undone.
  std::string addAll(const TellLabels& tell_labels) {
    labels_say_something_ = false;
    std::vector<StructuralLabel> labels;
    return forEachBlock([&](const fs::path& file, const PcdCloud& cloud, const std::vector<LidarPoint>& points) {
      if (tell_labels) {
        std::string reason = tell_labels(file, cloud, points, labels);
        if (!reason.empty()) return reason;
        labels_say_something_ =
            labels_say_something_ || std::any_of(labels.begin(), labels.end(),
                                                 [](StructuralLabel label) { return label != StructuralLabel::NOISE; });
      }
      map_->builder.continueScan(viewOf(points), tell_labels ? LabelView(labels) : LabelView(),
                                 Eigen::Isometry3d::Identity(), options_.threads);
      return std::string();
    });
  }

  void addWithHeights() {
    GroundSurface ground;
    {
      LowestHeights heights;
      forEachBlock([&](const fs::path&, const PcdCloud&, const std::vector<LidarPoint>& points) {
        for (const LidarPoint& point : points) heights.add(&point.x);
        return std::string();
      });
      ground = heights.surface();
    }
    addAll([&ground](const fs::path&, const PcdCloud&, const std::vector<LidarPoint>& points,
                     std::vector<StructuralLabel>& labels) {
      labels.resize(points.size());
      std::transform(points.begin(), points.end(), labels.begin(), [&ground](const LidarPoint& point) {
        return ground.isGround(&point.x) ? StructuralLabel::GROUND : StructuralLabel::NON_GROUND;
      });
      return std::string();
    });
  }

  fs::path cloud_;
  MapImportOptions options_;
  CloudMapFiles files_;
  std::optional<ImportedMap> map_;
  bool labels_say_something_ = false;
};

}  // namespace

void MapImportOptions::check() const {
  MapOrigin origin;
  origin.resolution_m = resolution_m;
  origin.check();
  checkOption(block_points >= 1, "block_points", block_points, "1 or more");
  if (!origin_m) return;
  for (const double coordinate : *origin_m) checkOption(std::isfinite(coordinate), "origin_m", coordinate, "finite");
}

ImportedMap importMap(const fs::path& cloud, const MapImportOptions& options) {
  options.check();
  return Importer(cloud, options).run();
}

}  // namespace saw_ndt
