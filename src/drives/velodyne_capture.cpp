#include "drives/velodyne_capture.h"

#include <pcl/console/print.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/capture_file.h"
#include "io/velodyne_lasers.h"
#include "io/velodyne_turns.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

namespace {

/// A firing of a packet of the capture.
struct FiringPlace {
  std::int64_t packet = 0;  // CaptureFile::position()
  std::size_t firing = 0;
};

struct CapturedScan {
  FiringPlace first;
  FiringPlace last;
  double stamp_s = 0.0;
};

/// What was captured of one sensor.
class CapturedSensor {
 public:
  explicit CapturedSensor(VelodyneProduct product) : product_(product) {
    if (product.model) turns_.emplace(*product.model);
  }

  /// @param packet  a data packet of the sensor's product
  void add(const std::uint8_t* packet, double time_s, std::int64_t position) {
    ++packet_count_;
    if (!turns_) return;
    const std::vector<TurnFiring>& firings = turns_->add(packet, time_s);
    for (std::size_t i = 0; i < firings.size(); ++i) {
      if (firings[i].ended_a_scan) scans_.push_back(current_);
      if (firings[i].begins_scan) {
        current_.first = {position, i};
        current_.stamp_s = firings[i].time_s;
      }
      current_.last = {position, i};
    }
  }

  std::vector<CapturedScan> takeScans() {
    if (turns_ && turns_->endsWithScan()) scans_.push_back(current_);
    return std::move(scans_);
  }

  const VelodyneProduct& product() const { return product_; }
  std::size_t packetCount() const { return packet_count_; }

 private:
  VelodyneProduct product_;
  std::optional<VelodyneTurns> turns_;
  std::size_t packet_count_ = 0;
  CapturedScan current_;
  std::vector<CapturedScan> scans_;
};

// Packets of more senders than that are of no network of LiDARs.
constexpr std::size_t kMostSensors = 64;

class VelodyneCapture : public Recording {
 public:
  VelodyneCapture(const std::filesystem::path& path, const RecordingOptions& options)
      : Recording(path, path.stem().string()), file_(path) {
    std::map<std::uint32_t, CapturedSensor> sensors = findSensors();
    const auto sensor = chooseSensor(sensors, options.topic);
    address_ = sensor->first;
    const VelodyneProduct& product = sensor->second.product();
    if (!product.model) throw Error(path.string(), ipv4Text(address_), unreadProduct(product.id));
    if (*product.model == VelodyneModel::HDL_64E && options.velodyne_calibration.empty()) {
      throw Error(path.string(), ipv4Text(address_),
                  "data packets of an HDL-64E, which cannot be read without its calibration (db.xml)");
    }
    lasers_.emplace(*product.model, options.velodyne_calibration);
    scans_ = sensor->second.takeScans();
    if (scans_.empty()) {
      throw Error(path.string(), ipv4Text(address_),
                  "the " + std::to_string(sensor->second.packetCount()) + " data packets are no half turn");
    }
    for (const CapturedScan& scan : scans_) stamps_s_.push_back(scan.stamp_s);
    if (!file_.cutReason().empty()) {
      PCL_WARN("%s: read to where it is cut short: %s\n", path.c_str(), file_.cutReason().c_str());
    }
    if (file_.fragmentCount() > 0) {
      PCL_WARN("%s: %zu fragments of UDP packets were left out\n", path.c_str(), file_.fragmentCount());
    }
  }

  int scanCount() const override { return static_cast<int>(scans_.size()); }

  std::string scanName(int scan) const override {
    std::array<char, 16> name{};
    std::snprintf(name.data(), name.size(), "%06zu", requireScan(scan));
    return name.data();
  }

  void readScan(int scan, ScanPoints& points) const override;

  bool isRaw() const override { return true; }
  bool hasStamps() const override { return true; }
  const std::vector<double>& stamps() const override { return stamps_s_; }
  std::string stampsPlace() const override { return path().string(); }

  bool hasPoses() const override { return false; }
  std::optional<Eigen::Isometry3d> referencePose(int scan) const override {
    requireScan(scan);
    return std::nullopt;
  }

 private:
  std::map<std::uint32_t, CapturedSensor> findSensors();
  std::map<std::uint32_t, CapturedSensor>::iterator chooseSensor(std::map<std::uint32_t, CapturedSensor>& sensors,
                                                                 const std::string& topic) const;
  std::optional<VelodyneProduct> nextDataPacket(UdpPayload& payload) const;

  mutable CaptureFile file_;
  std::uint32_t address_ = 0;
  std::optional<VelodyneLasers> lasers_;
  std::vector<CapturedScan> scans_;
  std::vector<double> stamps_s_;
};

std::optional<VelodyneProduct> VelodyneCapture::nextDataPacket(UdpPayload& payload) const {
  while (file_.next(payload)) {
    if (const auto product = velodyneProduct(payload.bytes, payload.size)) return product;
  }
  return std::nullopt;
}

std::map<std::uint32_t, CapturedSensor> VelodyneCapture::findSensors() {
  std::map<std::uint32_t, CapturedSensor> sensors;
  UdpPayload payload;
  while (const std::optional<VelodyneProduct> product = nextDataPacket(payload)) {
    auto sensor = sensors.find(payload.source_address);
    if (sensor == sensors.end()) {
      if (sensors.size() == kMostSensors) continue;
      sensor = sensors.emplace(payload.source_address, CapturedSensor(*product)).first;
    }
    if (sensor->second.product().model != product->model) continue;
    sensor->second.add(payload.bytes, file_.time_s(), file_.position());
  }
  return sensors;
}

std::map<std::uint32_t, CapturedSensor>::iterator VelodyneCapture::chooseSensor(
    std::map<std::uint32_t, CapturedSensor>& sensors, const std::string& topic) const {
  if (sensors.empty()) {
    std::string reason =
        "none of the " + std::to_string(file_.frameCount()) + " packets is a data packet of a Velodyne";
    if (file_.fragmentCount() > 0) {
      reason += "; " + std::to_string(file_.fragmentCount()) + " are fragments, which are not put together";
    }
    if (!file_.cutReason().empty()) reason += "; " + file_.cutReason();
    throw Error(path().string(), "", reason);
  }
  if (topic.empty()) {
    return std::max_element(sensors.begin(), sensors.end(), [](const auto& a, const auto& b) {
      return a.second.packetCount() < b.second.packetCount();
    });
  }
  std::string addresses;
  for (auto sensor = sensors.begin(); sensor != sensors.end(); ++sensor) {
    const std::string address = ipv4Text(sensor->first);
    if (address == topic) return sensor;
    addresses += (addresses.empty() ? "" : ", ") + address;
  }
  throw Error(path().string(), "", "no Velodyne sent from " + topic + ", only from " + addresses);
}

void VelodyneCapture::readScan(int scan, ScanPoints& points) const {
  const CapturedScan& place = scans_[requireScan(scan)];
  points.points.clear();
  points.rings.clear();
  points.times_s.clear();
  points.width = 0;
  points.height = 1;

  // Turns by themselves, so that times grow from the stamp as they did when the scans were found.
  VelodyneTurns turns(lasers_->model());
  std::optional<double> to_stamp_s;
  UdpPayload payload;
  file_.seek(place.first.packet);
  for (;;) {
    const std::optional<VelodyneProduct> product = nextDataPacket(payload);
    if (!product || file_.position() > place.last.packet) {
      throw Error(path().string(), "scan " + scanName(scan), "the file is no longer what it was when it was opened");
    }
    if (payload.source_address != address_ || product->model != lasers_->model()) continue;
    const std::vector<TurnFiring>& firings = turns.add(payload.bytes, file_.time_s());
    const bool is_last = file_.position() == place.last.packet;
    const std::size_t first = file_.position() == place.first.packet ? place.first.firing : 0;
    const std::size_t end = is_last ? std::min(place.last.firing + 1, firings.size()) : firings.size();
    for (std::size_t i = first; i < end; ++i) {
      if (!to_stamp_s) to_stamp_s = place.stamp_s - firings[i].time_s;
      lasers_->addReturns(payload.bytes, firings[i].firing, firings[i].time_s + *to_stamp_s, points);
    }
    if (is_last) break;
  }
  points.width = points.points.size();
}

}  // namespace

std::unique_ptr<Recording> openVelodyneCapture(const std::filesystem::path& path, const RecordingOptions& options) {
  return std::make_unique<VelodyneCapture>(path, options);
}

}  // namespace saw_ndt::internal
