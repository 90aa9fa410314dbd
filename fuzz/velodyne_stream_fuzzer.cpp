// What comes in at the port of a Velodyne: packets of any size, whose lengths and times stand before them.
#include <fuzzer/FuzzedDataProvider.h>

#include <cmath>

#include "fuzzed_scan_file.h"
#include "io/velodyne_calibration_text.h"
#include "io/velodyne_stream.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace saw_ndt;
  static const TemporaryFolder folder;
  static const std::filesystem::path calibration = folder.write("db.xml", calibrationText(64));
  FuzzedDataProvider provider(data, size);
  internal::VelodyneStream stream(provider.ConsumeBool() ? calibration : std::filesystem::path());
  double host_s = 1.6e9;
  while (provider.remaining_bytes() > 0) {
    host_s += 1e-4 * provider.ConsumeIntegral<std::int16_t>();
    const std::size_t length = internal::kVelodynePacketBytes - provider.ConsumeIntegral<std::uint8_t>();
    const std::vector<std::uint8_t> packet = provider.ConsumeBytes<std::uint8_t>(length);
    stream.add(packet.data(), packet.size(), host_s, [](internal::StreamedScan& scan) {
      requireConsistent(scan.points);
      require(std::isfinite(scan.stamp_s), "stamps are finite");
    });
    if (packet.size() % 7 == 6) stream.restart();
  }
  return 0;
}
