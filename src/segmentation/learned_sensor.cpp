#include <algorithm>
#include <cmath>
#include <limits>

#include "common/no_return.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/segmentation/sensor_setup.h"
#include "segmentation/beam_groups.h"
#include "segmentation/beam_matching.h"

namespace saw_ndt {

using namespace internal;

namespace {

// A range image has some fewer columns than a beam fires in a turn, so that jitter leaves none of them empty.
constexpr double kColumnsPerFiring = 0.864;
// By how much the columns of a known sensor may differ from those seen: another rate of turning.
constexpr double kSameColumns = 0.25;
constexpr char kNoBeams[] = "no-rings";

double medianGap(const std::vector<float>& falling) {
  std::vector<float> gaps;
  for (std::size_t i = 1; i < falling.size(); ++i) gaps.push_back(falling[i - 1] - falling[i]);
  if (gaps.empty()) return 0.0;
  std::nth_element(gaps.begin(), gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2), gaps.end());
  return gaps[gaps.size() / 2];
}

int columnsOf(const BeamGroups& beams, const ScanView& scan) {
  std::vector<double> steps;
  for (const BeamGroup& group : beams.groups) {
    if (group.step_deg > 0.0) steps.push_back(group.step_deg);
  }
  if (steps.empty()) return 0;
  std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2), steps.end());
  const double firings = 360.0 / steps[steps.size() / 2];
  // The rows of an organized scan are firings of one clock, which do not jitter.
  const double row = static_cast<double>(beams.evidence == "rows" ? std::max(scan.width, scan.height) : scan.width);
  if (scan.height > 1 && std::abs(row - firings) < 0.1 * firings) return static_cast<int>(row);
  return static_cast<int>(std::lround(std::clamp(kColumnsPerFiring * firings, 8.0, 16384.0)));
}

/// The known sensor whose beams are the nearest to those seen, from the top down; none where no sensor's are near.
/// @param count  of all groups, be they without points; 0 where it is not known
const SensorModel* knownSensor(const std::vector<SensorModel>& known, const std::vector<float>& elevations_deg,
                               int count) {
  // Of the gap between two beams. Where rings or rows are known their own elevations are the better ones, but for
  // noise; in file order sensors that were calibrated apart count as one.
  const double greatest_misfit = count > 0 ? 0.1 : 0.6;
  // Of the beams between the outermost seen. Those beyond may see nothing but sky.
  constexpr double kLeastSeen = 0.85;
  constexpr double kUnseenBeam = 0.2;
  const double gap = medianGap(elevations_deg);
  const SensorModel* best = nullptr;
  double least_cost = std::numeric_limits<double>::infinity();
  BeamMatching matching;
  for (const SensorModel& model : known) {
    if (model.rows() == 0 || (count > 0 && count != model.rows())) continue;
    const double misfit = matching.match(elevations_deg, {}, model) / gap;
    if (!(misfit <= greatest_misfit)) continue;
    const auto groups = static_cast<double>(elevations_deg.size());
    if (groups < kLeastSeen * (matching.rows().back() - matching.rows().front() + 1)) continue;
    const double cost = misfit + kUnseenBeam * (1.0 - groups / model.rows());
    if (cost > least_cost) continue;
    least_cost = cost;
    best = &model;
  }
  return best;
}

/// The sensor whose points are given in a frame that stands on its head.
SensorModel upsideDown(SensorModel model) {
  model.name += " upside down";
  std::reverse(model.elevations_deg.begin(), model.elevations_deg.end());
  for (double& elevation_deg : model.elevations_deg) elevation_deg = -elevation_deg;
  return model;
}

/// Of those with the same beams the last one is taken: upside down comes first.
std::vector<SensorModel> knownSensors() {
  std::vector<SensorModel> models;
  for (const std::string& name : SensorModel::names()) models.push_back(upsideDown(SensorModel::named(name)));
  for (const std::string& name : SensorModel::names()) models.push_back(SensorModel::named(name));
  return models;
}

/// The elevations of all groups, from the top down. Those without points, as of beams that look at the sky, are between
/// or beyond the others, where numbers and elevations go together.
std::vector<float> allElevations(const BeamGroups& beams) {
  std::vector<float> elevations_deg;
  for (const BeamGroup& group : beams.groups) elevations_deg.push_back(static_cast<float>(group.elevation_deg));
  if (beams.areInOrder()) {
    const double first = beams.groups.front().elevation_deg, last = beams.groups.back().elevation_deg;
    const int span = beams.groups.back().number - beams.groups.front().number;
    const double step = (last - first) / std::max(1, span);
    std::size_t next = 0;  // the first group whose number is not below
    for (int number = 0; number < beams.count; ++number) {
      while (next < beams.groups.size() && beams.groups[next].number < number) ++next;
      if (next < beams.groups.size() && beams.groups[next].number == number) continue;
      double elevation_deg = first + step * (number - beams.groups.front().number);
      if (next > 0 && next < beams.groups.size()) {
        const BeamGroup &a = beams.groups[next - 1], &b = beams.groups[next];
        elevation_deg =
            a.elevation_deg + (b.elevation_deg - a.elevation_deg) * (number - a.number) / (b.number - a.number);
      } else if (next > 0) {
        elevation_deg = last + step * (number - beams.groups.back().number);
      }
      if (std::abs(elevation_deg) < 89.0) elevations_deg.push_back(static_cast<float>(elevation_deg));
    }
  }
  std::sort(elevations_deg.begin(), elevations_deg.end(), std::greater<>());
  return elevations_deg;
}

LearnedSensor sensorOf(const BeamGroups& beams, const ScanView& scan, const std::vector<SensorModel>& known) {
  std::vector<float> elevations_deg;
  for (const BeamGroup& group : beams.groups) elevations_deg.push_back(static_cast<float>(group.elevation_deg));
  std::sort(elevations_deg.begin(), elevations_deg.end(), std::greater<>());
  LearnedSensor learned;
  learned.evidence = beams.evidence;
  const int columns = columnsOf(beams, scan);
  if (const SensorModel* const model = knownSensor(known, elevations_deg, beams.numbered ? beams.count : 0)) {
    learned.model = *model;
    const bool other_rate = columns > 0 && std::abs(columns - model->columns) > kSameColumns * model->columns;
    if (other_rate) learned.model.columns = columns;
    return learned;
  }
  for (const float elevation_deg : allElevations(beams)) {
    // Rounding may have put two beams at one elevation.
    const double before = learned.model.elevations_deg.empty() ? 90.0 : learned.model.elevations_deg.back();
    learned.model.elevations_deg.push_back(std::min(static_cast<double>(elevation_deg), before - 1e-3));
  }
  learned.model.name = std::to_string(learned.model.rows()) + " beams";
  constexpr int kCommonColumns = 1800;
  learned.model.columns = columns > 0 ? columns : kCommonColumns;
  return learned;
}

/// Groups of points where elevations crowd, for scans whose points tell nothing else.
BeamGroups crowdedElevations(const ScanView& scan) {
  constexpr double kBin_deg = 0.05;
  constexpr float kLeastRange_m = 2.0F;
  constexpr auto kBins = static_cast<std::size_t>(180.0 / kBin_deg);
  std::vector<double> points(kBins, 0.0), sums(kBins, 0.0);
  double total = 0.0;
  for (std::size_t i = 0; i < scan.size; ++i) {
    const float* const p = scan.point(i);
    const float horizontal = std::hypot(p[0], p[1]);
    const float range = std::hypot(horizontal, p[2]);
    if (!(range > kLeastRange_m && range <= kFarthestReturn_m)) continue;
    const double elevation_deg = degreesFromRadians(std::atan2(p[2], horizontal));
    if (!(std::abs(elevation_deg) < kSteepestBeam_deg)) continue;
    const std::size_t bin = std::min(kBins - 1, static_cast<std::size_t>((elevation_deg + 90.0) / kBin_deg));
    points[bin] += 1.0;
    sums[bin] += elevation_deg;
    total += 1.0;
  }
  // A crowd is a run of bins that hold more than a hundredth of what an even share of 64 beams would.
  BeamGroups found;
  found.evidence = "elevations";
  const double least = total / 64.0 / 100.0;
  // Wider ones are of several beams.
  constexpr double kWidestBeam_deg = 0.25;
  constexpr double kMostWide = 0.1;
  double crowd = 0.0, sum = 0.0, used_bins = 0.0, width_deg = 0.0, wide = 0.0;
  for (std::size_t bin = 0; bin <= kBins; ++bin) {
    if (bin < kBins && points[bin] > least) {
      crowd += points[bin];
      sum += sums[bin];
      used_bins += 1.0;
      width_deg += kBin_deg;
    } else if (crowd > 0.0) {
      if (width_deg > kWidestBeam_deg) wide += crowd;
      width_deg = 0.0;
      BeamGroup group;
      group.number = found.count++;
      group.elevation_deg = sum / crowd;
      found.groups.push_back(group);
      crowd = sum = 0.0;
    }
  }
  // Elevations of any value fill the bins between the outermost.
  constexpr double kMostUsedShare = 0.5;
  constexpr std::size_t kLeastBeams = 4;
  if (found.groups.size() < kLeastBeams || found.groups.size() > kMostBeams || wide > kMostWide * total) return {};
  const double extent = (found.groups.back().elevation_deg - found.groups.front().elevation_deg) / kBin_deg;
  return used_bins < kMostUsedShare * extent ? found : BeamGroups{};
}

}  // namespace

LearnedSensor learnSensor(const ScanView& scan) {
  const std::vector<SensorModel> known = knownSensors();
  const std::vector<BeamGroups> candidates = beamGroupsOf(scan);
  for (const BeamGroups& groups : candidates) {
    if (groups.numbered && groups.areBeams()) return sensorOf(groups, scan, known);
  }
  // Beams that nothing blurs tell more than an order in which those that see nothing are missing.
  const BeamGroups crowds = crowdedElevations(scan);
  if (!crowds.groups.empty()) return sensorOf(crowds, scan, known);
  // Turns of a sensor without beams, or falls of some other order, are shorter.
  constexpr std::size_t kLeastPointsOfBeam = 150;
  for (const BeamGroups& groups : candidates) {
    const bool are_long = groups.groups.size() * kLeastPointsOfBeam <= scan.size;
    if (are_long && groups.areBeams() && groups.areInOrder()) return sensorOf(groups, scan, known);
  }
  LearnedSensor none;
  none.model = {kNoBeams, 1800, {}};
  none.evidence = "no beams";
  return none;
}

LearnedSensor learnSensor(const std::vector<ScanView>& scans) {
  std::vector<LearnedSensor> learned;
  for (const ScanView& scan : scans) learned.push_back(learnSensor(scan));
  const auto votes = [&](const LearnedSensor& sensor) {
    return std::count_if(learned.begin(), learned.end(),
                         [&](const LearnedSensor& other) { return other.model.name == sensor.model.name; });
  };
  return *std::max_element(learned.begin(), learned.end(),
                           [&](const LearnedSensor& a, const LearnedSensor& b) { return votes(a) < votes(b); });
}

}  // namespace saw_ndt
