#include "mpi/scan_dealer.h"

#include <algorithm>
#include <utility>

namespace saw_ndt::internal {
namespace {

// Statistics of so many scans are put together before they are sent: of more, little is saved.
constexpr std::size_t kMostScans = 32;
// Of what is left, a chunk is this share of a rank's part.
constexpr std::size_t kChunksLeftPerRank = 4;

}  // namespace

ScanDealer::ScanDealer(std::vector<std::vector<int>> scans, int rank_count)
    : scans_(std::move(scans)), rank_count_(static_cast<std::size_t>(rank_count)) {
  for (const std::vector<int>& of_drive : scans_) scan_count_ += of_drive.size();
}

std::optional<ScanChunk> ScanDealer::next() {
  while (drive_ < scans_.size() && next_ == scans_[drive_].size()) {
    ++drive_;
    next_ = 0;
  }
  if (drive_ == scans_.size()) return std::nullopt;
  const std::vector<int>& scans = scans_[drive_];
  const std::size_t share = (scan_count_ - dealt_) / (kChunksLeftPerRank * rank_count_);
  const std::size_t count = std::min(scans.size() - next_, std::clamp<std::size_t>(share, 1, kMostScans));
  const auto first = scans.begin() + static_cast<std::ptrdiff_t>(next_);
  next_ += count;
  dealt_ += count;
  return ScanChunk{static_cast<int>(drive_), {first, first + static_cast<std::ptrdiff_t>(count)}};
}

}  // namespace saw_ndt::internal
