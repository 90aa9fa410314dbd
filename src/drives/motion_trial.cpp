#include "saw_ndt/drives/motion_trial.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include "drives/reference_motion.h"
#include "localization/motion_compensation.h"
#include "localization/preparation_options.h"
#include "localization/source_voxel_filter.h"
#include "saw_ndt/map/weighted_map_builder.h"
#include "saw_ndt/registration/ndt_aligner.h"

namespace saw_ndt {

using namespace internal;

namespace {

constexpr std::size_t kMostLocalized = 10;
constexpr std::size_t kMostMapped = 20;
constexpr std::size_t kLeastScans = 4;

// A scan in which the LiDAR moves less tells nothing (m, of a point 20 m away).
constexpr double kLeastSkew_m = 0.2;

// What compensation must gain on average to be taken, as a share and in standard errors of the gain.
constexpr double kLeastGain = 0.01;
constexpr double kLeastGain_sigmas = 3.0;

// Scans nearer to each other see the same from the same side, skewed alike (m).
constexpr double kLeastSpacing_m = 2.5;

// One way of compensation, and how well each scan fits with it.
struct Candidate {
  MotionCompensation compensation = MotionCompensation::OFF;
  std::vector<double> fits;

  double mean() const {
    double sum = 0.0;
    for (const double fit : fits) sum += fit;
    return fits.empty() ? 0.0 : sum / static_cast<double>(fits.size());
  }
};

std::vector<Candidate> candidatesFor(const std::vector<RecordedScan>& scans) {
  const bool have_times = std::all_of(scans.begin(), scans.end(), [](const RecordedScan& scan) {
    return clockOf(viewOf(scan), scan.stamp_s).has_value();
  });
  if (have_times) return {{MotionCompensation::OFF, {}}, {MotionCompensation::FROM_TIMES, {}}};
  return {{MotionCompensation::OFF, {}},
          {MotionCompensation::FROM_AZIMUTH_COUNTERCLOCKWISE, {}},
          {MotionCompensation::FROM_AZIMUTH_CLOCKWISE, {}}};
}

double fitOf(const AlignmentResult& alignment) {
  return alignment.converged() ? alignment.likelihoods.unweighted * alignment.overlap : 0.0;
}

bool isBetter(const Candidate& candidate, const Candidate& other) {
  const auto count = static_cast<double>(other.fits.size());
  const double gain = candidate.mean() - other.mean();
  double squares = 0.0;
  for (std::size_t i = 0; i < other.fits.size(); ++i) {
    const double deviation = candidate.fits[i] - other.fits[i] - gain;
    squares += deviation * deviation;
  }
  const double sigma = std::sqrt(squares / (count * (count - 1.0)));
  return gain > kLeastGain * other.mean() && gain > kLeastGain_sigmas * sigma;
}

// The one that is better than every other, else OFF, which is the first.
MotionTrial decide(const std::vector<Candidate>& candidates) {
  MotionTrial trial;
  for (const Candidate& candidate : candidates) {
    const bool is_off = candidate.compensation == MotionCompensation::OFF;
    char text[64];
    std::snprintf(text, sizeof text, "%s%.2f %s", is_off ? "" : ", ", candidate.mean(),
                  is_off ? "as they are" : toString(candidate.compensation));
    trial.reason += text;
    const bool is_best = std::all_of(candidates.begin(), candidates.end(), [&](const Candidate& other) {
      return &other == &candidate || isBetter(candidate, other);
    });
    if (is_best) trial.compensation = candidate.compensation;
  }
  trial.reason = std::to_string(candidates.front().fits.size()) + " moving scans fit by " + trial.reason;
  return trial;
}

MotionTrial tooFewScans() {
  return {MotionCompensation::OFF,
          "too few scans of a moving vehicle to tell (" + std::to_string(kLeastScans) + " are needed)"};
}

double skewOf(const BodyMotion& motion, double period_s) {
  return shiftBetween(ScanMotion::even(motion), ScanMotion(), period_s);
}

// The first moving scans, and where the vehicle is at the first of them; those that cannot be read are left out.
struct MovingScans {
  std::vector<RecordedScan> scans;
  std::optional<Eigen::Isometry3d> T_map_base_initial;
  bool was_found = false;  // that is a pose of the map, not a guess
};

MovingScans firstMovingScans(Localizer localizer, const std::optional<Eigen::Isometry3d>& T_map_base_initial,
                             ScanSource& source) {
  MovingScans moving;
  moving.T_map_base_initial = T_map_base_initial;
  ScanPeriod period(localizer.options().scan_period_s);
  RecordedScan scan;
  while (moving.scans.size() < kMostLocalized && source.next(scan)) {
    if (!scan.failure.empty()) continue;
    if (moving.scans.empty()) {
      const LocalizationResult result = localizer.localize(viewOf(scan), scan.stamp_s, scan.priors);
      period.add(scan.stamp_s);
      const BodyMotion motion{result.track.velocity_base_mps, result.track.turn_rate_base_radps};
      const bool stands =
          result.accepted() && (!result.track.velocity_known || skewOf(motion, period.seconds()) < kLeastSkew_m);
      if (stands) {
        moving.T_map_base_initial = result.T_map_base;
        moving.was_found = true;
        continue;
      }
    }
    moving.scans.push_back(std::move(scan));
    scan = RecordedScan();
  }
  return moving;
}

void start(Localizer& localizer, const std::optional<Eigen::Isometry3d>& T_map_base_initial) {
  if (T_map_base_initial) {
    localizer.setInitialPose(*T_map_base_initial);
  } else {
    localizer.setUnknownPose();
  }
}

// A scan that was found as it is: where, and how the LiDAR moved from the scan before it to the one behind.
struct LocatedScan {
  std::size_t scan = 0;
  Eigen::Isometry3d T_map_base;
  BodyMotion lidar_motion;
};

// Skew moves poses of successive scans alike, so that it hardly changes the motion between them.
std::vector<LocatedScan> locatedAsTheyAre(const TiledTarget& target, const LocalizerOptions& options,
                                          const MovingScans& moving) {
  Localizer localizer(target, options);
  start(localizer, moving.T_map_base_initial);
  std::vector<LocalizationResult> results;
  for (const RecordedScan& scan : moving.scans) {
    results.push_back(localizer.localize(viewOf(scan), scan.stamp_s, scan.priors));
  }
  std::vector<LocatedScan> located;
  for (std::size_t i = 1; i + 1 < results.size(); ++i) {
    const double duration_s = results[i + 1].stamp_s - results[i - 1].stamp_s;
    if (!results[i - 1].accepted() || !results[i].accepted() || !results[i + 1].accepted() || duration_s <= 0.0)
      continue;
    const Eigen::Isometry3d T_before = results[i - 1].T_map_base * options.T_base_lidar;
    const Eigen::Isometry3d T_behind = results[i + 1].T_map_base * options.T_base_lidar;
    located.push_back({i, results[i].T_map_base, motionBetween(T_before.inverse() * T_behind, duration_s)});
  }
  return located;
}

// Fits of such scans once they are compensated by their motion, each found again from where it was.
std::vector<double> fitsOfCompensated(TiledTarget target, LocalizerOptions options,
                                      const std::vector<RecordedScan>& scans, const std::vector<LocatedScan>& located,
                                      MotionCompensation compensation) {
  options.search = false;
  const AlignmentOptions alignment = Localizer(target, options).options().alignment;
  ScanPreparation preparation(preparationFor(target, options));
  NdtAligner aligner;
  ScanPeriod period(options.scan_period_s);
  for (const RecordedScan& scan : scans) period.add(scan.stamp_s);
  std::vector<double> fits;
  for (const LocatedScan& at : located) {
    const RecordedScan& scan = scans[at.scan];
    ScanPoints compensated = scan;
    if (compensation != MotionCompensation::OFF) {
      compensateScan(viewOf(scan), compensation, {scan.stamp_s, period.seconds()}, ScanMotion::even(at.lidar_motion),
                     compensated.points);
    }
    const SourcePoints& source = preparation.prepare(viewOf(compensated));
    const NdtTarget target_there = target.at(at.T_map_base.translation(), 0.0);
    fits.push_back(fitOf(aligner.align(target_there, source, at.T_map_base, alignment)));
  }
  return fits;
}

// A scan with its labels and the motion during it.
struct ReferencedScan {
  RecordedScan scan;
  std::vector<StructuralLabel> labels;
  ScanMotion motion;
};

std::vector<ReferencedScan> movingScansOf(const DriveMapOptions& options, ScanSource& source) {
  std::vector<ReferencedScan> moving;
  ScanSegmenter segmenter(options.segmentation.value_or(SegmentationOptions()));
  RecordedScan scan;
  while (moving.size() < kMostMapped && source.next(scan)) {
    const auto motion = motionAt(options.trajectory, scan.stamp_s);
    if (!scan.failure.empty() || !scan.T_map_lidar || !motion) continue;
    if (skewOf(motion->before, options.scan_period_s) < kLeastSkew_m) continue;
    if (!moving.empty()) {
      const Eigen::Isometry3d T = moving.back().scan.T_map_lidar->inverse() * *scan.T_map_lidar;
      if (T.translation().norm() + kShiftArm_m * rotationAngle(T.linear()) < kLeastSpacing_m) continue;
    }
    ReferencedScan& added = moving.emplace_back();
    added.motion = *motion;
    added.scan = std::move(scan);
    if (options.segmentation) segmenter.segment(viewOf(added.scan), added.labels);
    scan = RecordedScan();
  }
  return moving;
}

// Fits of every second scan in the map of the others, then the other way round.
std::vector<double> fitsInOwnMaps(const std::vector<ReferencedScan>& scans, const DriveMapOptions& options,
                                  MotionCompensation compensation) {
  const bool labelled = options.segmentation.has_value();
  LocalizerOptions localizer_options;
  localizer_options.method = LocalizationMethod::named(labelled ? "weighted" : "classical");
  localizer_options.alignment.threads = options.threads;
  localizer_options.allow_other_segmentation = true;
  std::vector<LidarPoint> moved;
  const auto view = [&](const ReferencedScan& scan) {
    if (compensation == MotionCompensation::OFF) return viewOf(scan.scan);
    compensateScan(viewOf(scan.scan), compensation, {scan.scan.stamp_s, options.scan_period_s}, scan.motion, moved);
    return viewOf(moved);
  };
  SourceVoxelFilter filter(localizer_options.source_voxel_size_m);
  NdtAligner aligner;
  std::vector<double> fits;
  for (const std::size_t mapped : {0U, 1U}) {
    WeightedMapBuilder builder(options.resolution_m, options.segmentation);
    for (std::size_t i = mapped; i < scans.size(); i += 2) {
      builder.addScan(view(scans[i]), labelled ? LabelView(scans[i].labels) : LabelView(), *scans[i].scan.T_map_lidar);
    }
    const NdtTarget target(builder.build(), localizer_options.method.voxels, options.threads);
    const AlignmentOptions alignment = Localizer(target, localizer_options).options().alignment;
    for (std::size_t i = 1 - mapped; i < scans.size(); i += 2) {
      const SourcePoints& source = filter.filter(view(scans[i]), labelled ? &scans[i].labels : nullptr);
      fits.push_back(fitOf(aligner.align(target, source, *scans[i].scan.T_map_lidar, alignment)));
    }
  }
  return fits;
}

}  // namespace

MotionTrial tryMotionCompensation(const TiledTarget& target, const LocalizerOptions& options,
                                  const std::optional<Eigen::Isometry3d>& T_map_base_initial, ScanSource& scans) {
  LocalizerOptions with = options;
  with.motion_compensation = MotionCompensation::OFF;
  Localizer as_they_are(target, with);
  start(as_they_are, T_map_base_initial);
  const MovingScans moving = firstMovingScans(std::move(as_they_are), T_map_base_initial, scans);
  if (moving.scans.size() < kLeastScans) return tooFewScans();
  std::vector<Candidate> candidates = candidatesFor(moving.scans);
  // Those that go wrong need not be looked for.
  with.search = options.search && !moving.was_found;
  const std::vector<LocatedScan> located = locatedAsTheyAre(target, with, moving);
  if (located.size() >= kLeastScans) {
    for (Candidate& candidate : candidates) {
      candidate.fits = fitsOfCompensated(target, with, moving.scans, located, candidate.compensation);
    }
    return decide(candidates);
  }
  for (Candidate& candidate : candidates) {
    with.motion_compensation = candidate.compensation;
    Localizer localizer(target, with);
    start(localizer, moving.T_map_base_initial);
    for (const RecordedScan& scan : moving.scans) {
      if (localizer.track().isLost()) {
        candidate.fits.push_back(0.0);
        continue;
      }
      candidate.fits.push_back(fitOf(localizer.localize(viewOf(scan), scan.stamp_s, scan.priors).alignment));
    }
  }
  return decide(candidates);
}

MotionTrial tryMotionCompensation(const DriveMapOptions& options, ScanSource& scans) {
  options.check();
  const std::vector<ReferencedScan> moving = movingScansOf(options, scans);
  if (moving.size() < kLeastScans) return tooFewScans();
  std::vector<RecordedScan> recorded;
  for (const ReferencedScan& scan : moving) recorded.push_back(scan.scan);
  std::vector<Candidate> candidates = candidatesFor(recorded);
  for (Candidate& candidate : candidates) candidate.fits = fitsInOwnMaps(moving, options, candidate.compensation);
  return decide(candidates);
}

}  // namespace saw_ndt
