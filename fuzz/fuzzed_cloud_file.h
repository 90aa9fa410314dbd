#pragma once

#include "fuzzed_scan_file.h"
#include "io/cloud_blocks.h"
#include "saw_ndt/io/point_cloud_file.h"

namespace saw_ndt {

/// Reads a file of points with a header in every way that there is: as a scan, with labels, block by block.
inline void tryReadingCloud(FuzzedFile& file, const std::uint8_t* data, std::size_t size) {
  file.tryReading(data, size, [](const std::filesystem::path& path) { requireConsistent(readScanPoints(path)); });
  file.tryReading(data, size, [](const std::filesystem::path& path) { readPointCloud<pcl::PointXYZL>(path); });
  file.tryReading(data, size, [](const std::filesystem::path& path) {
    constexpr std::size_t kBlockPoints = 7;
    internal::CloudBlocks blocks(path, kBlockPoints);
    internal::PcdCloud block;
    std::uint64_t points = 0;
    while (blocks.next(block)) {
      require(blocks.firstPoint() == points && block.points > 0 && block.points <= kBlockPoints,
              "blocks follow each other");
      points += block.points;
    }
    require(points == blocks.header().points, "blocks have all points");
  });
}

}  // namespace saw_ndt
