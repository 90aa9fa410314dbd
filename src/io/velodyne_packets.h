#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

/// Size of a data packet of a Velodyne, the payload of a UDP packet.
constexpr std::size_t kVelodynePacketBytes = 1206;

/// The LiDARs whose packets are read.
enum class VelodyneModel { VLP_16, HDL_32E, HDL_64E };

/// What sent a data packet.
struct VelodyneProduct {
  std::optional<VelodyneModel> model;  ///< nothing where it is none of these
  int id = 0;                          ///< the product ID, last of the factory bytes; of no meaning for an HDL-64E
};

/// Tells data packets by their size and the identifiers of their 12 blocks: 0xEEFF alone, or by turns with 0xDDFF in
/// an HDL-64E's, whose factory bytes are no product ID.
/// @return nothing where the payload is no data packet, such as a position packet
SAW_NDT_EXPORT std::optional<VelodyneProduct> velodyneProduct(const std::uint8_t* payload, std::size_t size);

/// A clause for errors that names a product which is not read, and what is.
SAW_NDT_EXPORT std::string unreadProduct(int id);

/// All lasers once, one after the other.
struct VelodyneFiring {
  double azimuth = 0.0;           ///< at the first laser (0.01 degrees, clockwise, 0 to 36000)
  double azimuth_rate = 0.0;      ///< how fast it grows (0.01 degrees a microsecond)
  double time_us = 0.0;           ///< of the first laser, from the timestamp of the packet
  std::size_t block = 0;          ///< of the packet, that holds its first laser
  std::size_t channel = 0;        ///< its first laser's, within the block
  std::size_t second_return = 0;  ///< blocks from a return to the other one of the same laser; 0: there is none
};

/// The firings of a data packet, in order, by the timing that the manuals state:
///  - VLP-16: two firings a block, 55.296 us each, the lasers 2.304 us apart; the timestamp is the first laser's.
///  - HDL-32E: one a block, 46.08 us, 1.152 us; the timestamp is the last laser's.
///  - HDL-64E (S3): one a pair of blocks, 48 us, the 32 pairs of lasers in groups of four 1.2 us apart, a group every
///    6 us; the timestamp is the end of the last firing. Where it gives two returns: 57.6 us, 1.2 us, 7.2 us.
/// The azimuth of a block is that of its first laser; it grows evenly to the next block's, and behind the last one as
/// before it.
/// @param packet  kVelodynePacketBytes bytes of a data packet of this model
SAW_NDT_EXPORT void readVelodyneFirings(const std::uint8_t* packet, VelodyneModel model,
                                        std::vector<VelodyneFiring>& firings);

/// When a laser fires (us), from the first one of its firing.
/// @param two_returns  whether the sensor gives two returns a laser
SAW_NDT_EXPORT double velodyneLaserTime_us(VelodyneModel model, std::size_t laser, bool two_returns);

/// Microseconds of the sensor's clock since the hour.
SAW_NDT_EXPORT std::uint32_t velodyneTimestamp_us(const std::uint8_t* packet);

/// A distance (2 mm; 0: no return) and intensity (0 to 255).
struct VelodyneReturn {
  std::uint16_t distance = 0;
  std::uint8_t intensity = 0;
};

/// The return of a laser in a firing: where the sensor gives two, the more intense one, the first of them if both are.
SAW_NDT_EXPORT VelodyneReturn velodyneReturn(const std::uint8_t* packet, const VelodyneFiring& firing,
                                             std::size_t laser);

}  // namespace saw_ndt::internal
