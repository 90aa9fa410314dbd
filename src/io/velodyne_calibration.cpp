#include "io/velodyne_calibration.h"

#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <cmath>
#include <locale>
#include <sstream>
#include <string>

#include "common/input_file.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

namespace {

using boost::property_tree::ptree;

// Velodyne's are a tenth of that, and ten elements deep.
constexpr std::size_t kMostBytes = std::size_t{1} << 20;
constexpr int kMostDepth = 100;

constexpr double kDistanceUnit_cm = 0.2;
constexpr char kLasersPlace[] = "boost_serialization.DB.points_";

std::string readText(const std::filesystem::path& path) {
  std::ifstream stream = openInputFile(path);
  std::string text(kMostBytes + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (text.size() > kMostBytes) throw Error(path.string(), "", "is longer than any calibration of a Velodyne");
  return text;
}

/// The parser calls itself for every element within an element.
void requireShallow(const std::filesystem::path& path, const std::string& text) {
  int depth = 0;
  for (std::size_t i = 0; i + 1 < text.size(); ++i) {
    if (text[i] == '<' && text[i + 1] == '/') {
      --depth;
    } else if (text[i] == '/' && text[i + 1] == '>') {
      --depth;
    } else if (text[i] == '<' && text[i + 1] != '?' && text[i + 1] != '!') {
      ++depth;
    }
    if (depth > kMostDepth)
      throw Error(path.string(), "offset " + std::to_string(i), "elements within too many others");
  }
}

double numberOf(const std::filesystem::path& path, const std::string& place, const ptree& laser, const char* name) {
  std::istringstream text(laser.get<std::string>(name, ""));
  text.imbue(std::locale::classic());
  double number = 0.0;
  if (!(text >> number) || !std::isfinite(number))
    throw Error(path.string(), place, std::string(name) + " is no number");
  return number;
}

}  // namespace

std::array<VelodyneCorrection, 64> readVelodyneCalibration(const std::filesystem::path& path) {
  const std::string content = readText(path);
  requireShallow(path, content);
  ptree document;
  try {
    std::istringstream stream(content);
    read_xml(stream, document, boost::property_tree::xml_parser::trim_whitespace);
  } catch (const boost::property_tree::xml_parser_error& error) {
    throw Error(path.string(), "line " + std::to_string(error.line()), "no XML: " + error.message());
  }
  const auto lasers = document.get_child_optional(kLasersPlace);
  if (!lasers) throw Error(path.string(), kLasersPlace, "is missing: this is no calibration of an HDL-64E (db.xml)");
  const auto database = document.get_child("boost_serialization.DB");
  if (database.count("distLSB_") != 0 &&
      std::abs(numberOf(path, "boost_serialization.DB", database, "distLSB_") - kDistanceUnit_cm) > 1e-6) {
    throw Error(path.string(), "boost_serialization.DB", "distLSB_ is not 0.2 cm, as that of an HDL-64E is");
  }

  std::array<VelodyneCorrection, 64> corrections;
  std::array<bool, 64> stated{};
  for (const auto& [name, item] : *lasers) {
    const auto laser = item.get_child_optional("px");
    if (name != "item" || !laser) continue;
    const std::string place = "laser " + laser->get<std::string>("id_", "without id_");
    const double id = numberOf(path, place, *laser, "id_");
    if (id < 0.0 || id >= static_cast<double>(corrections.size()) || id != std::floor(id)) {
      throw Error(path.string(), place, "id_ must be 0 to 63");
    }
    const auto index = static_cast<std::size_t>(id);
    if (stated[index]) throw Error(path.string(), place, "is stated twice");
    stated[index] = true;
    VelodyneCorrection& correction = corrections[index];
    constexpr double kCentimetre = 0.01;
    correction.azimuth_deg = numberOf(path, place, *laser, "rotCorrection_");
    correction.elevation_deg = numberOf(path, place, *laser, "vertCorrection_");
    correction.distance_m = kCentimetre * numberOf(path, place, *laser, "distCorrection_");
    correction.vertical_offset_m = kCentimetre * numberOf(path, place, *laser, "vertOffsetCorrection_");
    correction.horizontal_offset_m = kCentimetre * numberOf(path, place, *laser, "horizOffsetCorrection_");
  }
  for (std::size_t laser = 0; laser < stated.size(); ++laser) {
    if (!stated[laser]) throw Error(path.string(), kLasersPlace, "laser " + std::to_string(laser) + " is missing");
  }
  return corrections;
}

}  // namespace saw_ndt::internal
