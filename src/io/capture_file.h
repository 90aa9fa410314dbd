#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "io/udp_payload.h"
#include "saw_ndt/common/export.h"

struct pcap;

namespace saw_ndt::internal {

/// A file of captured network packets (pcap or pcapng), read one after the other or from a place that is known.
class SAW_NDT_EXPORT CaptureFile {
 public:
  /// Throws Error where it cannot be opened, is no such file, or was captured from what is neither Ethernet, "any"
  /// device of Linux, a loopback device nor bare IP.
  explicit CaptureFile(const std::filesystem::path& path);

  /// Reads on to the next UDP packet.
  /// @param payload  valid until the next call
  /// @return false where there are no more; see cutReason()
  bool next(UdpPayload& payload);

  /// When the packet that next() read was captured (s since 1970).
  double time_s() const { return time_s_; }
  /// Where that packet is in the file.
  std::int64_t position() const { return position_; }
  /// Makes next() read the packet at a position() on.
  void seek(std::int64_t position);

  /// Why the file ended before its end, empty where it did not.
  const std::string& cutReason() const { return cut_reason_; }
  std::size_t frameCount() const { return frame_count_; }        ///< that were read so far
  std::size_t fragmentCount() const { return fragment_count_; }  ///< of these, parts of UDP packets

 private:
  struct Close {
    void operator()(pcap* handle) const;
  };

  std::filesystem::path path_;
  std::unique_ptr<pcap, Close> handle_;
  LinkLayer link_ = LinkLayer::IP;
  double time_s_ = 0.0;
  std::int64_t position_ = 0;
  std::string cut_reason_;
  std::size_t frame_count_ = 0;
  std::size_t fragment_count_ = 0;
};

}  // namespace saw_ndt::internal
