#include "io/bin_scan.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "io/binary_records.h"
#include "io/point_times.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

namespace {

// Windows of the sample: the least common multiple of 3, 4, 5 and 6, so that every column has the same share.
constexpr std::size_t kWindow = 60;
constexpr std::size_t kWindows = 12;
constexpr std::size_t kFewestPairs = 48;
constexpr int kFewestFields = 3, kMostFields = 8;
// Real and simulated scans are at 0.04 to 0.35 with the right number of fields, and from 0.73 with another one.
constexpr double kAlike = 0.5;
constexpr double kMuchMoreAlike = 0.6;

// UTM northings end at 1e7 m, and what sines of right angles leave of a range is not below 1e-20 m.
constexpr float kFarthest_m = 2e7F;
constexpr float kNearest_m = 1e-30F;
constexpr std::size_t kSampledPoints = 256;
constexpr double kFewWrong = 0.05;

constexpr double kGreatestBinRing = 1023.0;
constexpr double kRisingShare = 0.9;

/// The mean of |a - b| / (|a| + |b|) over numbers a, b that are `lag` places apart; none where there are too few.
std::optional<double> unlikeness(const float* values, std::size_t count, std::size_t lag) {
  const std::size_t reach = kWindow + lag;
  const std::size_t windows = count < reach ? 1 : kWindows;
  const std::size_t width = std::min(kWindow, count - std::min(count, lag));
  double sum = 0.0;
  std::size_t pairs = 0;
  for (std::size_t window = 0; window < windows; ++window) {
    const float* first = values + (windows == 1 ? 0 : (count - reach) * window / (windows - 1));
    for (std::size_t i = 0; i < width; ++i) {
      const float a = first[i], b = first[i + lag];
      const float size = std::abs(a) + std::abs(b);
      if (!(size > 0.0F) || !std::isfinite(size)) continue;
      sum += std::abs(a - b) / size;
      ++pairs;
    }
  }
  if (pairs < kFewestPairs) return std::nullopt;
  return sum / static_cast<double>(pairs);
}

bool isWrong(float coordinate) {
  const float size = std::abs(coordinate);
  return (size > kFarthest_m && std::isfinite(size)) || (size > 0.0F && size < kNearest_m);
}

std::vector<double> columnOf(const std::vector<float>& values, std::size_t fields, std::size_t column) {
  std::vector<double> numbers;
  numbers.reserve(values.size() / fields);
  for (std::size_t i = column; i < values.size(); i += fields) numbers.push_back(static_cast<double>(values[i]));
  return numbers;
}

/// The times where these are some: they rise from point to point, but for a few, and within the span of a scan.
std::vector<double> timesFrom(std::vector<double> numbers, const std::vector<LidarPoint>& points) {
  std::size_t rising = 0;
  for (std::size_t i = 1; i < numbers.size(); ++i) rising += numbers[i] >= numbers[i - 1] ? 1 : 0;
  if (static_cast<double>(rising) < kRisingShare * static_cast<double>(numbers.size() - 1)) return {};
  makeSeconds(numbers, points, false);
  const auto [least, greatest] = std::minmax_element(numbers.begin(), numbers.end());
  constexpr double kLongestScan_s = 1.5;
  if (numbers.empty() || !(*greatest - *least <= kLongestScan_s)) return {};
  return numbers;
}

}  // namespace

void requireBinFields(int bin_fields) {
  checkOption(bin_fields == 0 || (bin_fields >= kKittiFields && bin_fields <= 6), "bin_fields", bin_fields,
              "4, 5 or 6, or 0 where it is to be told from the values");
}

std::optional<int> tellBinFields(const float* values, std::size_t count) {
  const std::optional<double> kitti = unlikeness(values, count, kKittiFields);
  if (!kitti) return std::nullopt;
  if (*kitti < kAlike) return kKittiFields;
  int best = kKittiFields;
  double least = *kitti * kMuchMoreAlike;
  for (int fields = kFewestFields; fields <= kMostFields; ++fields) {
    const double value = unlikeness(values, count, static_cast<std::size_t>(fields)).value_or(1.0);
    // Numbers of twice as many fields are alike, too, but less so.
    if (value >= least) continue;
    best = fields;
    least = value;
  }
  if (best == kKittiFields) return std::nullopt;
  return best;
}

std::optional<int> tellBinFields(const std::filesystem::path& path) {
  try {
    std::vector<float> values;
    readWholeRecords(path, values);
    return tellBinFields(values.data(), values.size());
  } catch (const Error&) {
    return std::nullopt;
  }
}

int binFieldsOfScans(const std::vector<std::filesystem::path>& paths) {
  // A scan that is cut, empty or very small does not say.
  constexpr std::size_t kScansLookedAt = 10;
  for (std::size_t scan = 0; scan < std::min(paths.size(), kScansLookedAt); ++scan) {
    if (const std::optional<int> fields = tellBinFields(paths[scan])) return *fields;
  }
  return kKittiFields;
}

void requireScanCoordinates(const std::filesystem::path& path, const float* values, std::size_t count, int fields) {
  const std::size_t points = count / static_cast<std::size_t>(fields);
  const std::size_t sampled = std::min(points, kSampledPoints);
  std::size_t wrong = 0;
  float example = 0.0F;
  for (std::size_t i = 0; i < sampled; ++i) {
    const float* xyz = values + points * i / sampled * static_cast<std::size_t>(fields);
    const float* found = std::find_if(xyz, xyz + 3, isWrong);
    if (found == xyz + 3) continue;
    if (wrong++ == 0) example = *found;
  }
  if (static_cast<double>(wrong) <= kFewWrong * static_cast<double>(sampled)) return;
  std::ostringstream reason;
  reason << "is no scan of " << fields << " float32 a point: " << wrong << " of " << sampled
         << " points looked at have coordinates that no scan has, such as " << example << " m";
  throw Error(path.string(), "", reason.str());
}

void readBinScan(const std::filesystem::path& path, ScanPoints& scan, int bin_fields) {
  requireBinFields(bin_fields);
  scan.rings.clear();
  scan.times_s.clear();
  scan.height = 1;
  if (bin_fields == kKittiFields) {
    readRecords(path, scan.points);
    scan.width = scan.points.size();
    return requireScanCoordinates(path, &scan.points.front().x, kKittiFields * scan.points.size(), kKittiFields);
  }
  std::vector<float> values;
  const std::size_t size = readWholeRecords(path, values);
  const int fields = bin_fields != 0 ? bin_fields : tellBinFields(values.data(), values.size()).value_or(kKittiFields);
  if (fields < kKittiFields || fields > 6) {
    throw Error(path.string(), "", "seems to have " + std::to_string(fields) + " float32 a point: 4, 5 or 6 are read");
  }
  const auto width = static_cast<std::size_t>(fields);
  requireScanCoordinates(path, values.data(), values.size(), fields);
  requireWholeRecords(path, size, width * sizeof(float));
  scan.points.resize(values.size() / width);
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const float* at = values.data() + i * width;
    scan.points[i] = {at[0], at[1], at[2], at[3]};
  }
  scan.width = scan.points.size();
  for (std::size_t column = kKittiFields; column < width; ++column) {
    std::vector<double> numbers = columnOf(values, width, column);
    std::vector<std::uint16_t> rings = ringsFrom(numbers, scan.points, kGreatestBinRing);
    if (scan.rings.empty() && !rings.empty()) {
      scan.rings = std::move(rings);
    } else if (scan.times_s.empty()) {
      scan.times_s = timesFrom(std::move(numbers), scan.points);
    }
  }
}

}  // namespace saw_ndt::internal
