#include "io/velodyne_stream.h"

#include <pcl/console/print.h>

namespace saw_ndt::internal {

VelodyneStream::VelodyneStream(const std::filesystem::path& calibration) {
  if (!calibration.empty()) calibrated_.emplace(VelodyneModel::HDL_64E, calibration);
}

bool VelodyneStream::isTaken(const std::uint8_t* payload, std::size_t size) {
  const std::optional<VelodyneProduct> product = velodyneProduct(payload, size);
  if (!product) return false;
  if (!product->model) {
    warnOnce(unreadProduct(product->id));
    return false;
  }
  if (lasers_ != nullptr) return *product->model == lasers_->model();
  if (*product->model == VelodyneModel::HDL_64E) {
    if (!calibrated_) {
      warnOnce("data packets of an HDL-64E, which cannot be read without its calibration (db.xml)");
      return false;
    }
    lasers_ = &*calibrated_;
  } else {
    if (!uncalibrated_ || uncalibrated_->model() != *product->model) uncalibrated_.emplace(*product->model);
    lasers_ = &*uncalibrated_;
  }
  turns_.emplace(*product->model);
  return true;
}

void VelodyneStream::warnOnce(const std::string& reason) {
  if (!has_warned_) PCL_WARN("Velodyne: %s\n", reason.c_str());
  has_warned_ = true;
}

void VelodyneStream::restart() {
  lasers_ = nullptr;
  turns_.reset();
}

void VelodyneStream::begin(double stamp_s) {
  scan_.stamp_s = stamp_s;
  scan_.points.points.clear();
  scan_.points.rings.clear();
  scan_.points.times_s.clear();
}

void VelodyneStream::finish() {
  scan_.points.width = scan_.points.points.size();
  scan_.points.height = 1;
}

}  // namespace saw_ndt::internal
