// Localization maps whose bytes are not what they were, or were made to do harm.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "expect_throws.h"
#include "localization/localization_map_forger.h"
#include "localization/place_index.h"
#include "localization/place_table.h"
#include "map/localization_map_file.h"
#include "map/map_fixtures.h"
#include "map/quantized_cell.h"
#include "report/localization_map_summary.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/localization/global_search.h"
#include "saw_ndt/localization/localization_method.h"
#include "saw_ndt/localization/map_pack.h"
#include "saw_ndt/map/tiled_target.h"
#include "saw_ndt/registration/ndt_aligner.h"
#include "temporary_folder.h"

namespace saw_ndt {

using namespace internal;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A scan that one can look for.
SourcePoints scanOf(unsigned seed) {
  SourcePoints points;
  points.labelled = true;
  for (const pcl::PointXYZL& point : mixedCloud(seed, 1200)) {
    points.add(point.x, point.y, point.z, static_cast<StructuralLabel>(point.label));
  }
  return points;
}

bool isFinite(const NdtTarget& target) {
  const auto levelIsFinite = [](const NdtLevel& level) {
    for (const PackedNdtCell& cell : level.packedCells()) {
      for (const float value : cell.mean_from_centre) {
        if (!std::isfinite(value)) return false;
      }
      for (const float value : cell.inverse_covariance) {
        if (!std::isfinite(value)) return false;
      }
      if (!std::isfinite(cell.weight)) return false;
    }
    return true;
  };
  return std::all_of(target.levels().begin(), target.levels().end(), levelIsFinite) && levelIsFinite(target.coarse());
}

class DamagedLocalizationMap : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder.path() / name).string(); }

  /// Of some tiles, each with a search table.
  std::string goodBytes(int points, const std::vector<Eigen::Vector2d>& places) const {
    WeightedMapBuilder builder(0.5);
    for (const Eigen::Vector2d& place : places) {
      Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
      T.translation() << place, 0.0;
      addCloud(builder, mixedCloud(1, points), T);
    }
    builder.build().save(path("statistics"));
    packMap(path("statistics"), path("good"), LocalizationMethod::named("weighted").voxels);
    return contentOf(path("good"));
  }

  /// Uses all that a file has, in every way; everything that comes of it is finite.
  void useAll() const {
    const LocalizationMap map(path("damaged"));
    const NdtTarget target = map.target(1);
    ASSERT_TRUE(isFinite(target));
    for (std::size_t i = 0; i < map.file().tileCount(); ++i) {
      PlaceIndex::Tile tile;
      const std::string_view table = map.file().searchTable(map.file().tile(i));
      if (!table.empty() && !decodePlaceTile(table, tile)) throw Error(map.path(), "", "no table");
    }
  }
  /// Likewise, and localizes in it.
  void useAndLocalize(const SourcePoints& scan) const {
    useAll();
    const LocalizationMap map(path("damaged"));
    for (const double x_m : {0.0, 60.0, -1e9, 1e30}) map.targetAround({x_m, 1.0, 0.0}, 30.0, 1);
    map.targetAround(Eigen::Vector3d::Zero(), kInfinity, 1);
    summarize(map);
    for (const PoseCandidate& candidate : GlobalSearch(map).candidates(scan, {}, 1)) {
      ASSERT_TRUE(candidate.T_map_base.matrix().allFinite());
    }
    GlobalSearch(map).candidates(scan, SearchRegion{Eigen::Isometry3d::Identity(), 100.0, 20.0}, 1);
    TiledTarget tiles(map);
    const AlignmentResult result =
        NdtAligner().align(tiles.at(Eigen::Vector3d::Zero(), 50.0), scan, Eigen::Isometry3d::Identity(), {});
    ASSERT_TRUE(result.T_map_source.matrix().allFinite());
  }

  void expectRefused(const std::string& bytes, const std::string& reason = "") const {
    folder.writeAnew("damaged", bytes);
    expectThrows<Error>([&] { useAll(); }, {path("damaged"), reason});
  }
  void expectRefusedOrHarmless(const Forger& forged, const SourcePoints& scan) const {
    folder.writeAnew("damaged", forged.bytes());
    try {
      useAndLocalize(scan);
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(path("damaged")), std::string::npos) << error.what();
    }
  }

  TemporaryFolder folder;
};

TEST_F(DamagedLocalizationMap, EveryByteAndEveryPrefixIsRefused) {
  const std::string good = goodBytes(400, {{32, 32}});
  folder.writeAnew("damaged", good);
  useAll();
  for (std::size_t i = 0; i < good.size(); ++i) {
    for (const char flip : {'\x01', '\xFF'}) {
      std::string bytes = good;
      bytes[i] = static_cast<char>(bytes[i] ^ flip);
      SCOPED_TRACE(i);
      expectRefused(bytes);
    }
    SCOPED_TRACE(i);
    expectRefused(good.substr(0, i));
  }
  expectRefused(good + "x");
  expectThrows<Error>([&] { LocalizationMap(path("none")); }, {path("none"), "No such file"});
  expectThrows<Error>([&] { LocalizationMap(folder.path().string()); }, {"directory"});
}

TEST_F(DamagedLocalizationMap, AHeaderOfAbsurdNumbersIsRefusedOrHarmless) {
  const Forger good(goodBytes(60, {{0, 0}, {70, 0}}));
  const SourcePoints scan = scanOf(1);
  const auto expectRefusedWith = [&](const auto& change, const std::string& reason) {
    expectRefused(good.header(change).bytes(), reason);
  };
  using Header = LocalizationMapHeader;
  constexpr auto kHuge = std::numeric_limits<std::uint64_t>::max();
  for (const double resolution_m : {0.0, -0.5, kInfinity, kNaN, 5e-324, 1e-310, 1e300}) {
    expectRefusedWith([&](Header& header) { header.resolution_m = resolution_m; }, "resolution");
  }
  for (const double resolution_m : {1e-9, 1e-3, 1e9}) {
    expectRefusedOrHarmless(good.header([&](Header& header) { header.resolution_m = resolution_m; }), scan);
  }
  const std::uint64_t size = good.bytes().size();
  for (const std::uint64_t count : {kHuge, kHuge / 40 + 1, size, size / 40 + 1, std::uint64_t{0}}) {
    expectRefusedWith([&](Header& header) { header.tile_count = count; }, "impossible layout");
  }
  for (const std::uint64_t offset : {kHuge, kHuge - 39, size + 1, std::uint64_t{159}, std::uint64_t{0}}) {
    expectRefusedWith([&](Header& header) { header.directory_offset = offset; }, "impossible layout");
  }
  for (const std::uint32_t bytes : {0xFFFFFFFFU, static_cast<std::uint32_t>(size)}) {
    expectRefusedWith([&](Header& header) { header.metadata_bytes = bytes; }, "impossible layout");
  }
  expectRefusedWith([&](Header& header) { header.metadata_bytes = 0; }, "checksum");
  for (const double extent_m : {kInfinity, -kInfinity, kNaN, 1e300}) {
    expectRefusedWith([&](Header& header) { header.least_m[0] = extent_m; }, "impossible extent");
    expectRefusedWith([&](Header& header) { header.greatest_m[1] = extent_m; }, "impossible extent");
  }
  expectRefusedOrHarmless(good.header([&](Header& header) { std::swap(header.least_m, header.greatest_m); }), scan);
  expectRefusedOrHarmless(good.header([&](Header& header) {
    header.scan_count = header.point_count = header.voxel_count = header.coarse_voxel_count = kHuge;
  }),
                          scan);
}

TEST_F(DamagedLocalizationMap, TilesThatPointAnywhereAreRefusedOrHarmless) {
  const Forger good(goodBytes(60, {{0, 0}, {70, 0}}));
  const SourcePoints scan = scanOf(1);
  using Record = LocalizationTileRecord;
  constexpr auto kHuge = std::numeric_limits<std::uint64_t>::max();
  for (const std::uint64_t offset : {kHuge, kHuge - 31, std::uint64_t{1} << 63U, std::uint64_t{good.bytes().size()},
                                     std::uint64_t{159}, std::uint64_t{0}}) {
    expectRefused(good.record(0, [&](Record& record) { record.offset = offset; }).bytes(), "outside of the file");
  }
  for (const std::uint32_t bytes : {0xFFFFFFFFU, 0x80000000U}) {
    expectRefused(good.record(0, [&](Record& record) { record.cell_bytes = bytes; }).bytes(), "outside of the file");
    expectRefused(good.record(0, [&](Record& record) { record.table_bytes = bytes; }).bytes(), "outside of the file");
  }
  for (const int at : {std::numeric_limits<int>::min(), std::numeric_limits<int>::max(), -16000000, 16000000}) {
    expectRefused(good.record(0, [&](Record& record) { record.x = at; }).bytes(), "too far out");
    expectRefused(good.record(1, [&](Record& record) { record.y = at; }).bytes(), "too far out");
  }
  expectRefusedOrHarmless(good.record(0, [&](Record& record) { record.voxel_count = 0xFFFFFFFFU; }), scan);
  expectRefusedOrHarmless(good.record(0, [&](Record& record) { record.x = -14000000; }), scan);
}

// A small file must not make a large map.
TEST_F(DamagedLocalizationMap, TilesThatShareBytesOrAreOutOfOrderAreRefused) {
  const Forger good(goodBytes(60, {{0, 0}, {70, 0}, {0, 70}, {70, 70}}));
  const SourcePoints scan = scanOf(1);
  const std::size_t count = good.tileCount();
  ASSERT_GE(count, 4U);
  std::vector<std::size_t> numbers(count);
  for (std::size_t i = 0; i < count; ++i) numbers[i] = count - 1 - i;
  expectRefused(good.directory(numbers).bytes(), "out of order");
  expectRefusedOrHarmless(good.directory(numbers), scan);
  expectRefused(good.directory({0, 0}).bytes(), "out of order");
  expectRefusedOrHarmless(good.directory({0, 0}), scan);
  expectRefusedOrHarmless(good.directory({count - 1, 0, count - 1, 0, count - 1, 0, 1, 2, 1, 2}), scan);

  Forger many = good.directory(std::vector<std::size_t>(2000, 0));
  for (std::size_t i = 0; i < many.tileCount(); ++i) {
    many = many.record(i, [&](LocalizationTileRecord& record) {
      record.x = static_cast<std::int32_t>(i % 50);
      record.y = static_cast<std::int32_t>(i / 50);
    });
  }
  expectRefused(many.bytes(), "overlap");
  folder.writeAnew("damaged", many.bytes());
  const LocalizationMap map(path("damaged"));
  expectThrows<Error>([&] { GlobalSearch(map).candidates(scan, {}, 1); }, {"overlap"});
  expectThrows<Error>([&] { map.targetAround(Eigen::Vector3d::Zero(), 1e4, 1); }, {"overlap"});
  expectThrows<Error>([&] { summarize(map); }, {"overlap"});
}

TEST_F(DamagedLocalizationMap, AbsurdCellsAreRefusedOrHarmless) {
  const Forger good(goodBytes(400, {{0, 0}}));
  const SourcePoints scan = scanOf(1);
  constexpr std::size_t kHeadBytes = 8, kCellBytes = sizeof(QuantizedCell);
  const std::size_t levels = LocalizationMap(path("good")).file().resolutions().size();
  const std::size_t heads = levels * kHeadBytes;
  for (std::size_t level = 0; level < levels; ++level) {
    for (const std::uint32_t count : {0xFFFFFFFFU, 0x80000000U, 0x08000000U, 1000000U}) {
      expectRefused(good.cells(0, [&](std::string& cells) { put(cells, level * kHeadBytes, count); }).bytes());
    }
    for (const std::int32_t z : {std::numeric_limits<std::int32_t>::min(), -2000000000, 2000000000}) {
      expectRefusedOrHarmless(good.cells(0, [&](std::string& cells) { put(cells, level * kHeadBytes + 4, z); }), scan);
    }
    expectRefused(good.cells(0,
                             [&](std::string& cells) {
                               put(cells, level * kHeadBytes + 4, std::numeric_limits<std::int32_t>::max());
                             })
                      .bytes());
  }
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, heads - 1, heads + 1}) {
    expectRefused(good.cells(0, [&](std::string& cells) { cells.resize(size); }).bytes());
  }
  const auto forEachCellOf = [&](const auto& change) {
    return good.cells(0, [&](std::string& cells) {
      for (std::size_t at = heads; at < cells.size(); at += kCellBytes) {
        auto cell = valueAt<QuantizedCell>(cells, at);
        change(cell);
        putLayout(cells, at, cell);
      }
    });
  };
  constexpr float kNoNumber = std::numeric_limits<float>::quiet_NaN();
  for (const float root : {kNoNumber, -1.0F, std::numeric_limits<float>::infinity(), 1e38F, 1.1e12F}) {
    expectRefused(forEachCellOf([&](QuantizedCell& cell) { cell.greatest_root = root; }).bytes(), "cannot be");
  }
  for (const float root : {0.0F, 1e-45F, 1e-30F, 1e12F}) {
    expectRefusedOrHarmless(forEachCellOf([&](QuantizedCell& cell) { cell.greatest_root = root; }), scan);
  }
  for (const std::uint8_t shape : {std::uint8_t{0}, std::uint8_t{4}, std::uint8_t{255}}) {
    expectRefused(forEachCellOf([&](QuantizedCell& cell) { cell.structure_class = shape; }).bytes(), "cannot be");
  }
  expectRefused(forEachCellOf([&](QuantizedCell& cell) { cell.place[0] = 0xFFFF; }).bytes(), "cannot be");
  expectRefusedOrHarmless(forEachCellOf([&](QuantizedCell& cell) { cell.place[2] = 0xFFFF; }), scan);
  for (const std::int16_t element : {std::int16_t{-32768}, std::int16_t{32767}, std::int16_t{0}}) {
    expectRefusedOrHarmless(forEachCellOf([&](QuantizedCell& cell) {
                              std::fill(std::begin(cell.root), std::end(cell.root), element);
                              std::fill(std::begin(cell.mean), std::end(cell.mean), std::uint16_t{0xFFFF});
                              cell.mean_confidence = 0xFFFF;
                            }),
                            scan);
  }
  // All cells of a level in one voxel, and those of a level the other way round.
  expectRefusedOrHarmless(
      forEachCellOf([&](QuantizedCell& cell) { cell.place[0] = cell.place[1] = cell.place[2] = 0; }), scan);
  expectRefusedOrHarmless(
      good.cells(0,
                 [&](std::string& cells) {
                   const auto count = valueAt<std::uint32_t>(cells, 0);
                   for (std::uint32_t i = 0; i < count / 2; ++i) {
                     std::swap_ranges(
                         cells.begin() + static_cast<std::ptrdiff_t>(heads + i * kCellBytes),
                         cells.begin() + static_cast<std::ptrdiff_t>(heads + (i + 1) * kCellBytes),
                         cells.begin() + static_cast<std::ptrdiff_t>(heads + (count - 1 - i) * kCellBytes));
                   }
                 }),
      scan);
}

TEST_F(DamagedLocalizationMap, SearchTablesThatAreNoneAreRefused) {
  const Forger good(goodBytes(400, {{32, 32}}));
  for (const std::string& table : {std::string("no table"), std::string(1000, '\xFF'), std::string("x\x9C\x03\0", 4)}) {
    expectRefused(good.table(0, [&](std::string& bytes) { bytes = table; }).bytes());
  }
  expectRefused(good.table(0, [&](std::string& bytes) { bytes.resize(bytes.size() - 1); }).bytes());
}

// What nobody thought of: numbers all over the file, each with checksums that hold.
TEST_F(DamagedLocalizationMap, AnyBytesWithChecksumsThatHoldAreRefusedOrHarmless) {
  const Forger good(goodBytes(100, {{0, 0}, {70, 0}}));
  const SourcePoints scan = scanOf(1);
  std::mt19937 random(5);
  const auto alter = [&random](unsigned char* bytes, std::size_t size) {
    constexpr unsigned char kValues[] = {0x00, 0x01, 0x7F, 0x80, 0xFF};
    const std::size_t first = random() % size, count = 1 + random() % std::min<std::size_t>(8, size - first);
    for (std::size_t i = first; i < first + count; ++i) {
      bytes[i] = random() % 2 == 0 ? kValues[random() % 5] : static_cast<unsigned char>(random());
    }
  };
  for (int trial = 0; trial < 300; ++trial) {
    SCOPED_TRACE(trial);
    Forger forged = good;
    switch (trial % 3) {
      case 0:
        forged = good.header([&](LocalizationMapHeader& header) {
          alter(reinterpret_cast<unsigned char*>(&header) + 16, sizeof header - 20);
        });
        break;
      case 1:
        forged = good.record(random() % 2, [&](LocalizationTileRecord& record) {
          alter(reinterpret_cast<unsigned char*>(&record), sizeof record - 4);
        });
        break;
      default:
        forged = good.cells(
            0, [&](std::string& cells) { alter(reinterpret_cast<unsigned char*>(cells.data()), cells.size()); });
    }
    expectRefusedOrHarmless(forged, scan);
  }
}

}  // namespace
}  // namespace saw_ndt
