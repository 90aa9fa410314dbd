#include "io/pcd_fields.h"

#include <cmath>
#include <limits>
#include <sstream>

#include "io/ply_cloud.h"
#include "io/point_times.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

namespace {

// As drivers and data sets name them, the most telling first.
const std::vector<std::string_view> kIntensityNames = {"intensity",    "i",           "intensities",
                                                       "reflectivity", "reflectance", "remission"};
const std::vector<std::string_view> kRingNames = {"ring",       "channel", "line",    "laser_id", "laserid",
                                                  "laser_ring", "beam",    "ring_id", "scan_line"};
const std::vector<std::string_view> kTimeNames = {"t",          "time",        "timestamp", "offset_time",
                                                  "time_stamp", "time_offset", "stamp",     "offsettime",
                                                  "timeoffset", "rel_time",    "time_us",   "time_ns"};
constexpr char kLabel[] = "label";

std::vector<double> numbersOf(const PcdCloud& cloud, const PcdColumn& column) {
  std::vector<double> numbers(cloud.points);
  cloud.forEach(column, [&](std::size_t point, double number) { numbers[point] = number; });
  return numbers;
}

}  // namespace

void requireScanExtension(const std::filesystem::path& path) {
  if (isBinScan(path) || isPly(path) || path.extension() == ".pcd") return;
  throw Error(path.string(), "", "the name of a point cloud must end in .pcd, .ply or .bin");
}

PcdCloud readCloudFile(const std::filesystem::path& path) {
  return isPly(path) ? readPlyCloud(path) : readPcdCloud(path);
}

std::vector<LidarPoint> pointsOf(const std::filesystem::path& path, const PcdCloud& cloud,
                                 const std::array<double, 3>& origin_m) {
  std::vector<LidarPoint> points(cloud.points);
  const std::pair<const char*, float LidarPoint::*> coordinates[] = {
      {"x", &LidarPoint::x}, {"y", &LidarPoint::y}, {"z", &LidarPoint::z}};
  auto origin = origin_m.begin();
  for (const auto& [name, member] : coordinates) {
    const PcdColumn* column = cloud.find({name});
    if (column == nullptr) throw Error(path.string(), "", std::string("has no field ") + name);
    cloud.forEach(*column, [&, to = member, from = *origin++](std::size_t point, double number) {
      points[point].*to = static_cast<float>(number - from);
    });
  }
  if (const PcdColumn* column = cloud.find(kIntensityNames)) {
    cloud.forEach(*column,
                  [&](std::size_t point, double number) { points[point].intensity = static_cast<float>(number); });
  }
  return points;
}

ScanPoints scanPointsOf(const std::filesystem::path& path, const PcdCloud& cloud) {
  ScanPoints scan;
  scan.points = pointsOf(path, cloud);
  scan.width = cloud.width;
  scan.height = cloud.height;
  if (const PcdColumn* column = cloud.find(kRingNames)) {
    constexpr double kGreatest = std::numeric_limits<std::uint16_t>::max();
    scan.rings = ringsFrom(numbersOf(cloud, *column), scan.points, kGreatest);
  }
  if (const PcdColumn* column = cloud.find(kTimeNames)) {
    scan.times_s = numbersOf(cloud, *column);
    makeSeconds(scan.times_s, scan.points, column->field.type != 'F');
  }
  return scan;
}

std::vector<std::uint32_t> labelsOf(const std::filesystem::path& path, const PcdCloud& cloud) {
  const PcdColumn* column = cloud.find({kLabel});
  if (column == nullptr) throw Error(path.string(), "", std::string("has no field ") + kLabel);
  std::vector<std::uint32_t> labels(cloud.points);
  cloud.forEach(*column, [&](std::size_t point, double number) {
    constexpr double kGreatest = std::numeric_limits<std::uint32_t>::max();
    if (!(number >= 0.0 && number <= kGreatest && number == std::floor(number))) {
      std::ostringstream reason;
      reason << "the label " << number << " is no whole number of 0 or more";
      throw Error(path.string(), "point " + std::to_string(point), reason.str());
    }
    labels[point] = static_cast<std::uint32_t>(number);
  });
  return labels;
}

PcdCloud cloudOf(const ScanPoints& scan) {
  PcdCloud cloud;
  cloud.points = scan.points.size();
  cloud.height = scan.height;
  cloud.width = scan.height > 1 ? scan.width : cloud.points;
  std::size_t offset = 0;
  for (const char* name : {"x", "y", "z", "intensity"}) {
    cloud.columns.push_back({{name, sizeof(float), 'F', 1}, offset, sizeof(LidarPoint)});
    offset += sizeof(float);
  }
  const auto* first = reinterpret_cast<const unsigned char*>(scan.points.data());
  cloud.bytes.assign(first, first + scan.points.size() * sizeof(LidarPoint));
  if (!scan.rings.empty()) cloud.set("ring", 'U', scan.rings);
  if (!scan.times_s.empty()) cloud.set("time", 'F', scan.times_s);
  return cloud;
}

}  // namespace saw_ndt::internal
