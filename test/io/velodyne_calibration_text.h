#pragma once

#include <sstream>
#include <string>

namespace saw_ndt {

/// What a calibration of an HDL-64E (db.xml) states of a laser.
inline std::string laserText(int id) {
  std::ostringstream text;
  text << "<item><px><id_>" << id << "</id_><rotCorrection_>" << (id % 2 == 0 ? 4.5 : -3.0) << "</rotCorrection_>"
       << "<vertCorrection_>" << 2.0 - 0.4 * id << "</vertCorrection_><distCorrection_>120</distCorrection_>"
       << "<vertOffsetCorrection_>21</vertOffsetCorrection_><horizOffsetCorrection_>2.6</horizOffsetCorrection_>"
       << "</px></item>\n";
  return text.str();
}

/// A calibration of so many lasers.
inline std::string calibrationText(int lasers, const std::string& more = "") {
  std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<boost_serialization><DB><distLSB_>0.2</distLSB_><points_>\n";
  for (int id = 0; id < lasers; ++id) text += laserText(id);
  return text + more + "</points_></DB></boost_serialization>\n";
}

}  // namespace saw_ndt
