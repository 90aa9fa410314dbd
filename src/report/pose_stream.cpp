#include "report/pose_stream.h"

#include <cerrno>
#include <cstring>
#include <iomanip>
#include <iostream>
#include <locale>
#include <nlohmann/json.hpp>

#include "io/tum_pose.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt {

namespace {

nlohmann::ordered_json toJson(const RecordedScan& scan, const LocalizationResult& result, std::size_t left_out) {
  nlohmann::ordered_json json = {{"scan", scan.number},           {"file", scan.name},
                                 {"stamp", result.stamp_s},       {"state", toString(result.track.status)},
                                 {"accepted", result.accepted()}, {"reason", toString(result.acceptance)}};
  if (result.track.pose_known) {
    const Eigen::Vector3d& t = result.T_map_base.translation();
    const Eigen::Quaterniond q(result.T_map_base.linear());
    const Vector6d sigma = standardDeviations(result.covariance, result.T_map_base.linear());
    json["position_m"] = {t.x(), t.y(), t.z()};
    json["orientation_xyzw"] = {q.x(), q.y(), q.z(), q.w()};
    json["sigma_xyz_m"] = {sigma[0], sigma[1], sigma[2]};
    json["sigma_rpy_deg"] = {degreesFromRadians(sigma[3]), degreesFromRadians(sigma[4]), degreesFromRadians(sigma[5])};
    json["degenerate"] = freeAxes(result.free_directions, result.T_map_base.linear());
  }
  json["likelihood"] = result.alignment.likelihood;
  json["overlap"] = result.alignment.overlap;
  json["total_ms"] = result.times.total_ms;
  json["left_out"] = left_out;
  return json;
}

void writeTum(std::ostream& stream, const RecordedScan& scan, const LocalizationResult& result, std::size_t left_out) {
  stream << "# scan " << scan.number << ' ' << toString(result.track.status) << ' ' << toString(result.acceptance);
  if (result.track.pose_known) {
    const Vector6d sigma = standardDeviations(result.covariance, result.T_map_base.linear());
    stream << std::fixed << std::setprecision(4) << " sigma_xyz_m " << sigma[0] << ' ' << sigma[1] << ' ' << sigma[2]
           << " sigma_rpy_deg " << degreesFromRadians(sigma[3]) << ' ' << degreesFromRadians(sigma[4]) << ' '
           << degreesFromRadians(sigma[5]);
  }
  stream << " left_out " << left_out << '\n';
  if (result.track.pose_known) internal::writeTumPose(stream, {result.stamp_s, result.T_map_base});
}

}  // namespace

PoseStream::PoseStream(const std::string& file, PoseStreamFormat format) : stream_(&std::cout), format_(format) {
  if (file == "-") return;
  errno = 0;
  file_.open(file, std::ios::binary);
  if (!file_) throw Error(file, "", errno != 0 ? std::strerror(errno) : "cannot be opened");
  file_.imbue(std::locale::classic());
  stream_ = &file_;
}

bool PoseStream::write(const RecordedScan& scan, const LocalizationResult& result, std::size_t left_out) {
  if (format_ == PoseStreamFormat::JSON) {
    *stream_ << toJson(scan, result, left_out).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
  } else {
    writeTum(*stream_, scan, result, left_out);
  }
  return static_cast<bool>(stream_->flush());
}

}  // namespace saw_ndt
