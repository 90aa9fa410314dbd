#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "app_options.h"
#include "saw_ndt/common/scan_view.h"
#include "saw_ndt/drives/scan_source.h"
#include "saw_ndt/segmentation/segmentation_options.h"

namespace saw_ndt {

/// The options by which every app that segments scans is told how, and what is learned from scans where they do not
/// say.
class SegmentationArguments {
 public:
  /// What is known besides the options.
  struct Knowledge {
    Eigen::Matrix3d R_base_lidar = Eigen::Matrix3d::Identity();  ///< of a level base; identity: not known
    std::optional<SegmentationOptions> of_map;                   ///< how the scans of the map were segmented
  };

  /// Declares them: -sensor, -mounting, -sensor-height, -ground-rule and so on. `app` must live as long as this.
  void addTo(AppOptions& app);

  /// What they say, with defaults for what they do not. @throws UsageError
  SegmentationOptions stated() const;

  /// The same with what is to be learned from scans, the first ones of a recording. Says on stderr what was learned,
  /// and warns of what in the first scan makes it doubtful. @throws UsageError
  SegmentationOptions learnedFrom(const std::vector<ScanPoints>& scans, const Knowledge& knowledge) const;
  SegmentationOptions learnedFrom(const std::vector<ScanPoints>& scans) const { return learnedFrom(scans, {}); }

 private:
  bool learnsSensor() const;
  bool learnsMounting() const;

  const AppOptions* app_ = nullptr;
  std::string sensor_;
  std::string mounting_;
  std::string ground_rule_;
  double max_range_m_ = 0.0;
  SegmentationOptions values_;
};

/// How many scans are learned from.
constexpr std::size_t kFirstScans = 5;

/// The first scans of a source that can be read, of kFirstScans.
std::vector<ScanPoints> firstScans(ScanSource& source);

}  // namespace saw_ndt
