// Captures of packets; the last byte says whether there is a calibration, without which an HDL-64E's are not read.
#include "fuzzed_recording.h"
#include "io/velodyne_calibration_text.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static saw_ndt::FuzzedFile file("drive.pcap");
  static const saw_ndt::TemporaryFolder folder;
  static const std::filesystem::path calibration = folder.write("db.xml", saw_ndt::calibrationText(64));
  saw_ndt::RecordingOptions options;
  if (size > 0 && data[size - 1] % 2 == 1) options.velodyne_calibration = calibration;
  saw_ndt::tryReadingRecording(file, data, size, options);
  return 0;
}
