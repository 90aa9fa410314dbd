#include "fuzzed_recording.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static saw_ndt::FuzzedFile file("drive.bag");
  saw_ndt::tryReadingRecording(file, data, size);
  return 0;
}
