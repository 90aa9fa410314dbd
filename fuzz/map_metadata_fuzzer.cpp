#include <string_view>

#include "fuzzed_file.h"
#include "map/map_metadata.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  saw_ndt::MapOrigin origin;
  if (const auto fault = saw_ndt::internal::readMetadata(text, origin)) {
    saw_ndt::require(fault->offset <= size && !fault->reason.empty(), "a fault lies in the text");
    return 0;
  }
  const std::string written = saw_ndt::internal::metadataText(origin);
  saw_ndt::MapOrigin again;
  saw_ndt::require(!saw_ndt::internal::readMetadata(written, again), "what was read can be written and read again");
  saw_ndt::require(saw_ndt::internal::metadataText(again) == written, "what is written is what was read");
  return 0;
}
