#include "io/velodyne_turns.h"

#include <algorithm>
#include <cmath>

namespace saw_ndt::internal {

namespace {

constexpr std::int64_t kHour_us = 3'600'000'000;
constexpr double kHour_s = 3600.0;
// No Velodyne takes longer for a turn, and so none is silent for longer.
constexpr std::int64_t kLongestGap_us = 250'000;
constexpr double kGpsAgreement_s = 0.1;
// Packets may wait for so long; where all do for longer than that, the clock of the host was set.
constexpr double kMostDelay_s = 0.5;
constexpr std::int64_t kLongestDisagreement_us = 2'000'000;
constexpr double kDrift = 1e-4;

constexpr double kTurn = 36000.0;  // 0.01 degrees
// Less than a turn by no more than this is a step back, of a packet that came late or of a sensor that stands.
constexpr double kMostStepBack = 1000.0;
// An HDL-64E that turns five times a second and gives two returns sends 1200 a turn. More are of a sensor that stands.
constexpr int kMostPackets = 2500;

}  // namespace

void VelodyneClock::begin(double host_s, std::uint32_t timestamp_us) {
  begun_ = true;
  elapsed_us_ = agreed_us_ = 0;
  const double of_hour_s = 1e-6 * timestamp_us;
  const double by_sensor_s = std::round((host_s - of_hour_s) / kHour_s) * kHour_s + of_hour_s;
  is_gps_ = std::abs(by_sensor_s - host_s) <= kGpsAgreement_s;
  offset_s_ = next_offset_s_ = is_gps_ ? by_sensor_s : host_s;
}

bool VelodyneClock::add(double host_s, std::uint32_t timestamp_us) {
  timestamp_us %= static_cast<std::uint32_t>(kHour_us);
  const double host_step_s = host_s - last_host_s_;
  std::int64_t step_us = static_cast<std::int64_t>(timestamp_us) - static_cast<std::int64_t>(last_us_);
  if (step_us > kHour_us / 2) step_us -= kHour_us;
  if (step_us < -kHour_us / 2) step_us += kHour_us;
  if (step_us == 0) {
    step_us = std::llround(1e6 * std::clamp(host_step_s, 0.0, 1e-6 * static_cast<double>(kLongestGap_us + 1)));
  }
  last_us_ = timestamp_us;
  last_host_s_ = host_s;
  const bool follows = begun_ && std::abs(step_us) <= kLongestGap_us;
  if (!follows) {
    begin(host_s, timestamp_us);
    return false;
  }
  elapsed_us_ += step_us;
  const double observed_s = host_s - 1e-6 * static_cast<double>(elapsed_us_);
  if (std::abs(observed_s - next_offset_s_) <= kMostDelay_s) agreed_us_ = elapsed_us_;
  if (elapsed_us_ - agreed_us_ > kLongestDisagreement_us) {
    is_gps_ = false;
    next_offset_s_ = observed_s;
    agreed_us_ = elapsed_us_;
  } else if (!is_gps_) {
    next_offset_s_ = std::min(next_offset_s_ + kDrift * 1e-6 * static_cast<double>(step_us), observed_s);
  }
  return true;
}

bool VelodyneTurns::coversHalf(double end_azimuth) const { return end_azimuth - first_azimuth_ >= kTurn / 2.0; }

const std::vector<TurnFiring>& VelodyneTurns::add(const std::uint8_t* packet, double host_s) {
  const bool follows = clock_.add(host_s, velodyneTimestamp_us(packet));
  const bool stands = ++packets_ > kMostPackets;
  bool is_cut_off = !follows || stands;
  readVelodyneFirings(packet, model_, packet_firings_);
  firings_.clear();
  for (const VelodyneFiring& firing : packet_firings_) {
    TurnFiring turn_firing;
    turn_firing.firing = firing;
    double step = firing.azimuth - last_azimuth_;
    if (step < 0.0) step += kTurn;
    const bool is_step_back = step > kTurn - kMostStepBack;
    const bool passes_zero = !is_step_back && firing.azimuth < last_azimuth_;
    if (!is_open_ || is_cut_off || passes_zero) {
      turn_firing.begins_scan = true;
      turn_firing.ended_a_scan =
          is_open_ && (passes_zero && !is_cut_off ? coversHalf(kTurn) : !stands && coversHalf(last_azimuth_));
      // A scan that follows another one begins at 0, even where its first packets are missing.
      first_azimuth_ = passes_zero && !is_cut_off && is_open_ ? 0.0 : firing.azimuth;
      is_open_ = true;
      is_cut_off = false;
      packets_ = 1;
      clock_.adjust();
      last_azimuth_ = firing.azimuth;
    } else if (!is_step_back) {
      last_azimuth_ = firing.azimuth;
    }
    turn_firing.time_s = clock_.time_s(firing.time_us);
    firings_.push_back(turn_firing);
  }
  return firings_;
}

}  // namespace saw_ndt::internal
