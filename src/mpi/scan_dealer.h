#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace saw_ndt::internal {

/// Scans of one drive that one rank works on, one after the other.
struct ScanChunk {
  int drive = 0;           ///< number of the drive, from 0
  std::vector<int> scans;  ///< numbers within the drive
};

/// Deals out the scans of several drives in chunks: scans that follow each other, since they see the same ground, many
/// at first and few at the end, so that all ranks are done at about the same time.
class ScanDealer {
 public:
  /// @param scans  of each drive, in the order in which they are dealt out
  ScanDealer(std::vector<std::vector<int>> scans, int rank_count);

  /// The next chunk; nothing where all scans have been dealt out.
  std::optional<ScanChunk> next();
  /// How many scans there are in all.
  std::size_t scanCount() const { return scan_count_; }

 private:
  std::vector<std::vector<int>> scans_;
  std::size_t rank_count_;
  std::size_t scan_count_ = 0, dealt_ = 0;
  std::size_t drive_ = 0, next_ = 0;  // the scan to come
};

}  // namespace saw_ndt::internal
