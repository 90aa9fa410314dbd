#include "io/velodyne_packets.h"

#include <array>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace saw_ndt::internal {

namespace {

constexpr std::size_t kBlocks = 12;
constexpr std::size_t kBlockBytes = 100;
constexpr std::size_t kBlockHeaderBytes = 4;
constexpr std::size_t kReturnBytes = 3;
constexpr std::size_t kChannels = 32;  // of a block
constexpr std::size_t kTimestampOffset = 1200;
constexpr std::size_t kModeOffset = 1204;
constexpr std::size_t kProductOffset = 1205;

constexpr std::uint16_t kUpperBlock = 0xEEFF;
constexpr std::uint16_t kLowerBlock = 0xDDFF;
constexpr std::uint8_t kTwoReturnsMode = 0x39;

constexpr int kTurn = 36000;  // 0.01 degrees
// From block to block no sensor turns farther than 0.8 degrees; it does where it leaves out a field of view.
constexpr int kMostBlockStep = 200;

constexpr std::size_t kLasersOfVlp16 = 16;

std::uint16_t readUint16(const std::uint8_t* bytes) {
  return static_cast<std::uint16_t>(bytes[0] | static_cast<unsigned>(bytes[1]) << 8);
}

std::uint16_t blockIdentifier(const std::uint8_t* packet, std::size_t block) {
  return readUint16(packet + block * kBlockBytes);
}

int blockAzimuth(const std::uint8_t* packet, std::size_t block) {
  return readUint16(packet + block * kBlockBytes + 2) % kTurn;
}

bool hasTwoReturns(const std::uint8_t* packet, VelodyneModel model) {
  if (model != VelodyneModel::HDL_64E) return packet[kModeOffset] == kTwoReturnsMode;
  // Nothing but its azimuths says so: those of two pairs of blocks are the same, packet-wide.
  for (std::size_t block = 0; block < kBlocks; block += 4) {
    if (blockAzimuth(packet, block) != blockAzimuth(packet, block + 2)) return false;
  }
  return blockAzimuth(packet, 0) != blockAzimuth(packet, kBlocks - 1);
}

/// How the firings of a model follow each other.
struct Timing {
  std::size_t blocks_a_step = 1;   ///< blocks that share an azimuth
  std::size_t firings_a_step = 1;  ///< firings in them
  double firing_us = 0.0;          ///< from one to the next
  double first_us = 0.0;           ///< of the first one, from the timestamp
  std::size_t second_return = 0;   ///< see VelodyneFiring
};

Timing timingOf(VelodyneModel model, bool two_returns) {
  Timing timing;
  if (model == VelodyneModel::VLP_16) {
    timing.firings_a_step = 2;
    timing.firing_us = 55.296;
  } else if (model == VelodyneModel::HDL_32E) {
    timing.firing_us = 46.08;
  } else {
    timing.blocks_a_step = 2;
    timing.firing_us = two_returns ? 57.6 : 48.0;
  }
  if (two_returns) {
    timing.second_return = timing.blocks_a_step;
    timing.blocks_a_step *= 2;
  }
  const auto steps = static_cast<double>(kBlocks / timing.blocks_a_step);
  if (model == VelodyneModel::HDL_32E) {
    timing.first_us = -((steps - 1.0) * timing.firing_us + velodyneLaserTime_us(model, kChannels - 1, two_returns));
  } else if (model == VelodyneModel::HDL_64E) {
    timing.first_us = -steps * timing.firing_us;
  }
  return timing;
}

}  // namespace

std::optional<VelodyneProduct> velodyneProduct(const std::uint8_t* payload, std::size_t size) {
  if (size != kVelodynePacketBytes) return std::nullopt;
  std::size_t upper = 0, lower = 0, other = 0;
  bool by_turns = true;
  for (std::size_t block = 0; block < kBlocks; ++block) {
    const std::uint16_t identifier = blockIdentifier(payload, block);
    // 0xCCFF and 0xBBFF are the third and fourth quarter of the 128 lasers of an Alpha Prime.
    const bool is_quarter = identifier == 0xCCFF || identifier == 0xBBFF;
    if (identifier != kUpperBlock && identifier != kLowerBlock && !is_quarter) return std::nullopt;
    ++(identifier == kUpperBlock ? upper : identifier == kLowerBlock ? lower : other);
    by_turns = by_turns && identifier == (block % 2 == 0 ? kUpperBlock : kLowerBlock);
  }
  VelodyneProduct product;
  product.id = payload[kProductOffset];
  if (by_turns) {
    product.model = VelodyneModel::HDL_64E;
  } else if (upper == kBlocks && product.id == 0x22) {
    product.model = VelodyneModel::VLP_16;
  } else if (upper == kBlocks && product.id == 0x21) {
    product.model = VelodyneModel::HDL_32E;
  }
  return product;
}

std::string unreadProduct(int id) {
  struct Named {
    int id;
    const char* name;
  };
  constexpr Named kNamed[] = {{0x24, " (Puck Hi-Res)"},
                              {0x28, " (VLP-32C)"},
                              {0x31, " (Velarray)"},
                              {0x63, " (VLS-128)"},
                              {0xA1, " (VLS-128)"}};
  std::ostringstream text;
  text << "data packets of product ID 0x" << std::hex << std::uppercase << std::setw(2) << std::setfill('0') << id;
  for (const Named& named : kNamed) {
    if (named.id == id) text << named.name;
  }
  text << ": only those of a VLP-16 (0x22), an HDL-32E (0x21) or an HDL-64E are read";
  return text.str();
}

double velodyneLaserTime_us(VelodyneModel model, std::size_t laser, bool two_returns) {
  if (model == VelodyneModel::VLP_16) return 2.304 * static_cast<double>(laser);
  if (model == VelodyneModel::HDL_32E) return 1.152 * static_cast<double>(laser);
  // Upper and lower lasers fire at once. The manual states how long before the timestamp, from the last laser on.
  const std::size_t from_last = kChannels - 1 - laser % kChannels;
  constexpr std::array<double, 4> kOneReturn_us = {2.34, 3.54, 4.74, 6.0};
  constexpr std::array<double, 4> kTwoReturns_us = {3.5, 4.7, 5.9, 7.2};
  const std::array<double, 4>& times_us = two_returns ? kTwoReturns_us : kOneReturn_us;
  constexpr double kGroups = 8.0;
  const auto group = static_cast<double>(from_last / times_us.size());
  return (kGroups - group) * times_us.back() - times_us[from_last % times_us.size()];
}

void readVelodyneFirings(const std::uint8_t* packet, VelodyneModel model, std::vector<VelodyneFiring>& firings) {
  firings.clear();
  const Timing timing = timingOf(model, hasTwoReturns(packet, model));
  const double step_us = timing.firing_us * static_cast<double>(timing.firings_a_step);
  int azimuth_step = 0;
  double time_us = timing.first_us;
  for (std::size_t block = 0; block < kBlocks; block += timing.blocks_a_step) {
    const int azimuth = blockAzimuth(packet, block);
    if (block + timing.blocks_a_step < kBlocks) {
      const int step = (blockAzimuth(packet, block + timing.blocks_a_step) - azimuth + kTurn) % kTurn;
      if (step <= kMostBlockStep) azimuth_step = step;
    }
    VelodyneFiring firing;
    firing.azimuth_rate = azimuth_step / step_us;
    firing.block = block;
    firing.second_return = timing.second_return;
    for (std::size_t i = 0; i < timing.firings_a_step; ++i) {
      const double within_us = timing.firing_us * static_cast<double>(i);
      firing.azimuth = std::fmod(azimuth + firing.azimuth_rate * within_us, kTurn);
      firing.time_us = time_us;
      firing.channel = i * kLasersOfVlp16;
      firings.push_back(firing);
      time_us += timing.firing_us;
    }
  }
}

std::uint32_t velodyneTimestamp_us(const std::uint8_t* packet) {
  return readUint16(packet + kTimestampOffset) | static_cast<std::uint32_t>(readUint16(packet + kTimestampOffset + 2))
                                                     << 16;
}

VelodyneReturn velodyneReturn(const std::uint8_t* packet, const VelodyneFiring& firing, std::size_t laser) {
  const std::size_t channel = firing.channel + laser;
  const auto returnOf = [&](std::size_t block) {
    const std::uint8_t* const bytes =
        packet + block * kBlockBytes + kBlockHeaderBytes + (channel % kChannels) * kReturnBytes;
    return VelodyneReturn{readUint16(bytes), bytes[2]};
  };
  const std::size_t block = firing.block + channel / kChannels;
  const VelodyneReturn first = returnOf(block);
  if (firing.second_return == 0) return first;
  const VelodyneReturn second = returnOf(block + firing.second_return);
  if (first.distance == 0) return second;
  return second.distance != 0 && second.intensity > first.intensity ? second : first;
}

}  // namespace saw_ndt::internal
