// Map files that were made to do harm: their checksums hold.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "map/map_file_layout.h"
#include "map_file_bytes.h"
#include "map_fixtures.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/map/map_merge.h"
#include "saw_ndt/map/map_update.h"
#include "temporary_folder.h"

namespace saw_ndt {

using namespace internal;

namespace {

bool isFinite(const NdtLevel& level) {
  const auto cellIsFinite = [](const PackedNdtCell& cell) {
    const auto isFiniteNumber = [](float value) { return std::isfinite(value); };
    return std::all_of(std::begin(cell.mean_from_centre), std::end(cell.mean_from_centre), isFiniteNumber) &&
           std::all_of(std::begin(cell.inverse_covariance), std::end(cell.inverse_covariance), isFiniteNumber) &&
           std::isfinite(cell.weight);
  };
  return std::all_of(level.packedCells().begin(), level.packedCells().end(), cellIsFinite);
}

class ForgedMap : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder.path() / name).string(); }
  std::string saved(const std::string& name, const WeightedVoxelMap& map) const {
    map.save(path(name));
    return path(name);
  }

  static WeightedVoxelMap smallMap(unsigned seed = 0) { return mapOf(mixedCloud(seed, 40), 0.5); }

  /// A file that was updated in place.
  std::string updatedBytes() const {
    const std::string map = saved("updated.map", smallMap());
    updateMapFile(map, {saved("added.map", smallMap(1))});
    return contentOf(map);
  }

  static std::size_t frontOf(const std::string& bytes) {
    return valueAt<std::uint32_t>(bytes, 8) == 4 ? valueAt<std::uint64_t>(bytes, 76) : kHeaderBytes;
  }
  static std::size_t tilesOf(const std::string& bytes) { return valueAt<std::uint64_t>(bytes, 56); }
  static std::size_t recordOf(const std::string& bytes, std::size_t tile) {
    return frontOf(bytes) + valueAt<std::uint32_t>(bytes, 68) + tile * kTileBytes;
  }

  /// Makes every checksum agree with the bytes. @param front  where metadata and directory are, `tiles` of them
  static void repair(std::string& bytes, std::size_t front, std::size_t metadata, std::size_t tiles) {
    for (std::size_t tile = 0; tile < tiles; ++tile) {
      const std::size_t record = front + metadata + tile * kTileBytes;
      const auto count = valueAt<std::uint64_t>(bytes, record + 16),
                 offset = valueAt<std::uint64_t>(bytes, record + 24);
      if (offset > bytes.size() || count > (bytes.size() - offset) / kEntryBytes) continue;
      put(bytes, record + 12, crc32(bytes.substr(offset, count * kEntryBytes)));
    }
    put(bytes, 64, crc32(bytes.substr(front + metadata, tiles * kTileBytes)));
    put(bytes, 72, crc32(bytes.substr(front, metadata)));
    put(bytes, 92, crc32(bytes.substr(0, 92)));
  }
  static void repair(std::string& bytes) {
    repair(bytes, frontOf(bytes), valueAt<std::uint32_t>(bytes, 68), tilesOf(bytes));
  }

  /// Uses a file in every way; false where it is refused.
  bool isTaken(const std::string& bytes) const {
    std::filesystem::remove(path("merged.map"));
    const std::string file = folder.writeAnew("forged.map", bytes).string();
    try {
      const WeightedVoxelMap map = WeightedVoxelMap::load(file);
      const NdtTarget target(map);
      EXPECT_TRUE(isFinite(target.fine()) && isFinite(target.coarse()));
      EXPECT_EQ(NdtTarget::load(file).voxelCount(), target.voxelCount());
      for (const double value : {map.resolution(), static_cast<double>(map.voxelCount({}, 1))}) {
        EXPECT_TRUE(std::isfinite(value));
      }
      mergeMapFiles({file}, path("merged.map"), 1);
      EXPECT_EQ(WeightedVoxelMap::load(path("merged.map")).entries().size(), map.entries().size());
      return true;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("forged.map"), std::string::npos) << error.what();
      return false;
    }
  }

  TemporaryFolder folder;
};

TEST_F(ForgedMap, WithAnyResolutionIsRefusedOrHarmless) {
  for (std::string bytes : {contentOf(saved("a.map", smallMap())), updatedBytes()}) {
    for (const double resolution_m : {1e-9, 1e-6, 1e3, 1e9}) {
      SCOPED_TRACE(resolution_m);
      put(bytes, 16, resolution_m);
      repair(bytes);
      isTaken(bytes);
    }
    for (const double resolution_m :
         {0.0, -0.5, std::nan(""), std::numeric_limits<double>::infinity(), 5e-324, 1e-310, 1e-30, 1e30, 1e300}) {
      put(bytes, 16, resolution_m);
      repair(bytes);
      EXPECT_FALSE(isTaken(bytes)) << resolution_m;
    }
  }
}

// In a file that was updated in place tiles may stand anywhere.
TEST_F(ForgedMap, TilesThatOverlapOrPointAnywhereAreRefusedOrHarmless) {
  const std::string good = updatedBytes();
  ASSERT_TRUE(isTaken(good));
  ASSERT_GE(tilesOf(good), 2U);
  constexpr auto kHuge = std::numeric_limits<std::uint64_t>::max();
  const std::size_t first = recordOf(good, 0), second = recordOf(good, 1);
  for (const std::uint64_t offset : {kHuge, kHuge - 83, std::uint64_t{1} << 63U, std::uint64_t{good.size()},
                                     std::uint64_t{good.size() - 1}, std::uint64_t{95}, std::uint64_t{0}}) {
    std::string bytes = good;
    put(bytes, first + 24, offset);
    repair(bytes);
    EXPECT_FALSE(isTaken(bytes)) << offset;
  }
  for (const std::uint64_t count : {kHuge, kHuge / kEntryBytes + 1, std::uint64_t{good.size()}, std::uint64_t{0}}) {
    std::string bytes = good;
    put(bytes, first + 16, count);
    repair(bytes);
    EXPECT_FALSE(isTaken(bytes)) << count;
  }
  // Both tiles have the bytes of the first one.
  std::string bytes = good;
  for (const std::size_t field : {std::size_t{16}, std::size_t{24}}) {
    put(bytes, second + field, valueAt<std::uint64_t>(good, first + field));
  }
  put(bytes, 48,
      valueAt<std::uint64_t>(good, 48) + valueAt<std::uint64_t>(good, first + 16) -
          valueAt<std::uint64_t>(good, second + 16));
  repair(bytes);
  isTaken(bytes);
  // A directory of more tiles than the file has room for entries.
  bytes = good;
  put(bytes, 56, std::uint64_t{1} << 32U);
  put(bytes, 92, crc32(bytes.substr(0, 92)));
  EXPECT_FALSE(isTaken(bytes));
}

TEST_F(ForgedMap, SumsThatNoPointsHaveAreRefusedOrHarmless) {
  const std::string good = contentOf(saved("a.map", smallMap()));
  const auto changed = [&](const auto& change) {
    std::string bytes = good;
    for (std::size_t at = recordOf(good, tilesOf(good)); at < bytes.size(); at += kEntryBytes) change(bytes, at);
    repair(bytes);
    return bytes;
  };
  const auto count = [](const std::string& bytes, std::size_t at) {
    return static_cast<std::int64_t>(valueAt<std::uint64_t>(bytes, at + 4) & 0xFFFFFFFFFFU);
  };
  // Covariances that are negative: the sums are as far out as they may be, the products are zero.
  isTaken(changed([&](std::string& bytes, std::size_t at) {
    for (std::size_t i = 0; i < 3; ++i) put(bytes, at + 12 + 8 * i, 32768 * count(bytes, at));
    for (std::size_t i = 0; i < 6; ++i) put(bytes, at + 36 + 8 * i, std::int64_t{0});
  }));
  // Variances of zero with covariances as large as can be, of either sign.
  for (const std::int64_t sign : {1, -1}) {
    isTaken(changed([&](std::string& bytes, std::size_t at) {
      for (std::size_t i = 0; i < 6; ++i) {
        const bool is_variance = i == 0 || i == 3 || i == 5;
        put(bytes, at + 36 + 8 * i, is_variance ? std::int64_t{0} : sign * 1073741824 * count(bytes, at));
      }
    }));
    isTaken(changed([&](std::string& bytes, std::size_t at) {
      for (std::size_t i = 0; i < 6; ++i) put(bytes, at + 36 + 8 * i, sign * 1073741824 * count(bytes, at));
    }));
  }
  EXPECT_FALSE(isTaken(changed(
      [](std::string& bytes, std::size_t at) { put(bytes, at + 12, std::numeric_limits<std::int64_t>::min()); })));
  // All of 2^40 - 1 points.
  std::string many = changed([](std::string& bytes, std::size_t at) {
    put(bytes, at + 4, (valueAt<std::uint64_t>(bytes, at + 4) & ~0xFFFFFFFFFFULL) | 0xFFFFFFFFFFULL);
  });
  put(many, 40, valueAt<std::uint64_t>(many, 48) * 0xFFFFFFFFFFULL);
  repair(many);
  isTaken(many);
  // Each entry twice.
  EXPECT_FALSE(isTaken(changed([&](std::string& bytes, std::size_t at) {
    if (at + 2 * kEntryBytes <= bytes.size()) bytes.replace(at + kEntryBytes, 4, bytes.substr(at, 4));
  })));
}

TEST_F(ForgedMap, AnyBytesWithChecksumsThatHoldAreRefusedOrHarmless) {
  std::mt19937 random(11);
  constexpr unsigned char kValues[] = {0x00, 0x01, 0x7F, 0x80, 0xFF};
  for (const std::string& good : {contentOf(saved("a.map", smallMap())), updatedBytes()}) {
    const std::size_t front = frontOf(good), metadata = valueAt<std::uint32_t>(good, 68), tiles = tilesOf(good);
    for (int trial = 0; trial < 400; ++trial) {
      SCOPED_TRACE(trial);
      std::string bytes = good;
      // The header, the directory or anything.
      const std::size_t begin = trial % 3 == 0 ? 12 : trial % 3 == 1 ? front + metadata : 96;
      const std::size_t end = trial % 3 == 0 ? 92 : trial % 3 == 1 ? begin + tiles * kTileBytes : bytes.size();
      const std::size_t first = begin + random() % (end - begin);
      for (std::size_t i = first; i < std::min(end, first + 1 + random() % 8); ++i) {
        bytes[i] = static_cast<char>(random() % 2 == 0 ? kValues[random() % 5] : random());
      }
      repair(bytes, front, metadata, tiles);
      isTaken(bytes);
    }
  }
}

}  // namespace
}  // namespace saw_ndt
