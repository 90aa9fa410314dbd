#include "io/capture_file.h"

#include <pcap/pcap.h>
#include <sys/types.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <optional>

#include "common/input_file.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

namespace {

std::optional<LinkLayer> linkLayerOf(int type) {
  switch (type) {
    case DLT_EN10MB:
      return LinkLayer::ETHERNET;
    case DLT_LINUX_SLL:
      return LinkLayer::LINUX_COOKED;
    case DLT_LINUX_SLL2:
      return LinkLayer::LINUX_COOKED_2;
    case DLT_NULL:
    case DLT_LOOP:
      return LinkLayer::LOOPBACK;
    case DLT_RAW:
    case DLT_IPV4:
      return LinkLayer::IP;
    default:
      return std::nullopt;
  }
}

}  // namespace

void CaptureFile::Close::operator()(pcap* handle) const { pcap_close(handle); }

CaptureFile::CaptureFile(const std::filesystem::path& path) : path_(path) {
  requireRegularFile(path);
  errno = 0;
  std::FILE* const file = std::fopen(path.c_str(), "rb");
  if (file == nullptr) throw Error(path.string(), "", std::strerror(errno));
  std::array<char, PCAP_ERRBUF_SIZE> reason{};
  handle_.reset(pcap_fopen_offline_with_tstamp_precision(file, PCAP_TSTAMP_PRECISION_NANO, reason.data()));
  if (!handle_) {
    std::fclose(file);
    throw Error(path.string(), "", reason.data());
  }
  const int type = pcap_datalink(handle_.get());
  const std::optional<LinkLayer> link = linkLayerOf(type);
  if (!link) {
    const char* const name = pcap_datalink_val_to_name(type);
    throw Error(path.string(), "",
                "packets of link type " + std::to_string(type) + (name ? std::string(" (") + name + ")" : "") +
                    ": only those of Ethernet, Linux's \"any\" device, a loopback device or bare IP are read");
  }
  link_ = *link;
}

bool CaptureFile::next(UdpPayload& payload) {
  std::FILE* const file = pcap_file(handle_.get());
  for (;;) {
    const off_t position = ftello(file);
    pcap_pkthdr* header = nullptr;
    const unsigned char* frame = nullptr;
    const int result = pcap_next_ex(handle_.get(), &header, &frame);
    if (result != 1) {
      if (result == PCAP_ERROR) cut_reason_ = pcap_geterr(handle_.get());
      return false;
    }
    ++frame_count_;
    payload = udpPayload(link_, frame, header->caplen);
    if (payload.kind == UdpPayload::Kind::FRAGMENT) ++fragment_count_;
    if (payload.kind != UdpPayload::Kind::UDP) continue;
    time_s_ = static_cast<double>(header->ts.tv_sec) + 1e-9 * static_cast<double>(header->ts.tv_usec);
    position_ = position;
    return true;
  }
}

void CaptureFile::seek(std::int64_t position) {
  if (fseeko(pcap_file(handle_.get()), static_cast<off_t>(position), SEEK_SET) != 0) {
    throw Error(path_.string(), "offset " + std::to_string(position), std::strerror(errno));
  }
}

}  // namespace saw_ndt::internal
