#include "fuzzed_file.h"
#include "report/sensor_model_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static saw_ndt::FuzzedFile file("sensor.json");
  file.tryReading(data, size, [](const std::filesystem::path& path) { saw_ndt::readSensorModel(path).check(); });
  return 0;
}
