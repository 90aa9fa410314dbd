#include "fuzzed_file.h"
#include "io/udp_payload.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using saw_ndt::internal::LinkLayer;
  constexpr LinkLayer kLayers[] = {LinkLayer::ETHERNET, LinkLayer::LINUX_COOKED, LinkLayer::LINUX_COOKED_2,
                                   LinkLayer::LOOPBACK, LinkLayer::IP};
  if (size == 0) return 0;
  const std::uint8_t* frame = data + 1;
  const auto payload = saw_ndt::internal::udpPayload(kLayers[data[0] % 5], frame, size - 1);
  saw_ndt::require(
      payload.bytes == nullptr || (payload.bytes >= frame && payload.bytes + payload.size <= frame + size - 1),
      "a payload lies in its frame");
  return 0;
}
