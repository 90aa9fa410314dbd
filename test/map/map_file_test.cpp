#include "map/map_file.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "expect_throws.h"
#include "map/map_tile.h"
#include "map_file_bytes.h"
#include "map_fixtures.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/pcl/cloud_view.h"
#include "saw_ndt/version.h"
#include "temporary_folder.h"

namespace saw_ndt {

using namespace internal;

namespace {

using internal::inMapOrder;
using internal::tileOf;

class MapFile : public ::testing::Test {
 protected:
  std::string path(const std::string& name = "a.map") const { return (folder.path() / name).string(); }

  std::string bytesOf(const WeightedVoxelMap& map) const {
    map.save(path("saved.map"));
    return contentOf(path("saved.map"));
  }

  void expectRefused(const std::string& content, std::initializer_list<std::string> parts) const {
    const std::string file = folder.writeAnew("damaged.map", content).string();
    expectThrows<Error>([&] { WeightedVoxelMap::load(file); }, {file});
    expectThrows<Error>([&] { WeightedVoxelMap::load(file); }, parts);
    expectThrows<Error>([&] { NdtTarget::load(file); }, parts);
  }

  /// A map as every version holds it.
  std::vector<std::string> allVersionsOf(const WeightedVoxelMap& map) const {
    const std::string bytes = bytesOf(map);
    return {bytes, asVersion2(bytes), asVersion1(bytes)};
  }

  /// Two points of one voxel, ground and non-ground.
  static WeightedVoxelMap tinyMap() {
    pcl::PointCloud<pcl::PointXYZL> cloud;
    cloud.resize(2);
    cloud[0].getVector3fMap() << -0.5F, 65.75F, 3.0F;
    cloud[0].label = 1;
    cloud[1].getVector3fMap() << -0.25F, 65.5F, 3.5F;
    cloud[1].label = 2;
    return mapOf(cloud, 1.0);
  }

  TemporaryFolder folder;
};

TEST_F(MapFile, TinyMapByteForByte) {
  // Voxel (-1, 65, 3) is voxel (63, 1, 3) of tile (-1, 1, 0), whose edge is 64 voxels. Half a voxel is 32768 steps.
  const std::string one_of_one_scan("\1\0\0\0\0\1\0\0", 8);  // 40 bits and 24
  std::string entries = std::string("\x3F\x01\x03\x01", 4) + one_of_one_scan;
  for (const std::int64_t sum : {0, 16384, -32768}) entries += littleEndian(sum);
  for (const std::int64_t product : {0, 0, 0, 268435456, -536870912, 1073741824}) entries += littleEndian(product);
  entries += std::string("\x3F\x01\x03\x02", 4) + one_of_one_scan;
  for (const std::int64_t sum : {16384, 0, 0}) entries += littleEndian(sum);
  for (const std::int64_t product : {268435456, 0, 0, 0, 0, 0}) entries += littleEndian(product);
  ASSERT_EQ(entries.size(), 2 * kEntryBytes);

  const std::string metadata = "software_version = " SAW_NDT_VERSION "\nsegmentation = none\n";
  const std::string directory = littleEndian(std::int32_t{-1}) + littleEndian(std::int32_t{1}) +
                                littleEndian(std::int32_t{0}) + littleEndian(crc32(entries)) +
                                littleEndian(std::uint64_t{2}) + littleEndian(std::uint64_t{136 + metadata.size()}) +
                                littleEndian(std::uint64_t{0});
  ASSERT_EQ(directory.size(), kTileBytes);

  std::string header = "SAWNDTM\n" + littleEndian(std::uint32_t{3}) + littleEndian(std::uint32_t{96}) +
                       std::string("\0\0\0\0\0\0\xF0\x3F", 8) +  // 1.0 as IEEE 754
                       littleEndian(std::uint32_t{64}) + littleEndian(std::uint32_t{1});
  for (const std::uint64_t count : {1, 2, 2, 1}) header += littleEndian(count);  // scans, points, entries, tiles
  header += littleEndian(crc32(directory)) + littleEndian(static_cast<std::uint32_t>(metadata.size())) +
            littleEndian(crc32(metadata)) + std::string(16, '\0');
  header += littleEndian(crc32(header));
  ASSERT_EQ(header.size(), kHeaderBytes);

  EXPECT_TRUE(bytesOf(tinyMap()) == header + metadata + directory + entries);
  ASSERT_EQ(crc32("123456789"), 0xCBF43926U);  // the check value of this CRC
}

TEST_F(MapFile, RoundTripKeepsEverything) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = Eigen::Vector3d(-200.0, 130.0, 64.0);
  for (const bool labelled : {true, false}) {
    WeightedMapBuilder builder(0.7);
    for (unsigned seed = 0; seed < 3; ++seed) {
      const pcl::PointCloud<pcl::PointXYZL> cloud = mixedCloud(seed, 4000, 90.0F);
      labelled ? addCloud(builder, cloud, T) : addCloud(builder, withoutLabels(cloud), T);
    }
    const WeightedVoxelMap map = builder.build();
    map.save(path());
    const WeightedVoxelMap loaded = WeightedVoxelMap::load(path());
    EXPECT_EQ(loaded.resolution(), 0.7);
    EXPECT_EQ(loaded.labelled(), labelled);
    EXPECT_EQ(loaded.origin().scan_count, 3U);
    EXPECT_EQ(loaded.origin().point_count, 12000U);
    EXPECT_EQ(loaded.origin().software_version, SAW_NDT_VERSION);
    ASSERT_EQ(loaded.entries().size(), map.entries().size());
    for (std::size_t i = 0; i < map.entries().size(); ++i) {
      ASSERT_EQ(loaded.entries()[i].voxel, map.entries()[i].voxel);
      ASSERT_EQ(loaded.entries()[i].label, map.entries()[i].label);
      ASSERT_EQ(loaded.entries()[i].sums, map.entries()[i].sums);
      ASSERT_EQ(loaded.entries()[i].scan_count, map.entries()[i].scan_count);
    }
    EXPECT_TRUE(bytesOf(loaded) == contentOf(path()));
  }
}

TEST_F(MapFile, TellsHowTheMapWasMade) {
  SegmentationOptions segmentation;
  segmentation.sensor = SensorModel::named("OS-128");
  segmentation.mounting_pitch_deg = 0.1;
  segmentation.ground.rule = GroundRule::INCLINATION;
  WeightedMapBuilder builder(1.0, segmentation);
  addCloud(builder, mixedCloud(1, 1000), Eigen::Isometry3d::Identity());
  const std::string bytes = bytesOf(builder.build());
  const MapOrigin origin = WeightedVoxelMap::load(path("saved.map")).origin();
  EXPECT_EQ(origin.software_version, SAW_NDT_VERSION);
  ASSERT_TRUE(origin.segmentation);
  EXPECT_FALSE(firstDifference(*origin.segmentation, segmentation));
  EXPECT_FALSE(firstDifference(*NdtTarget::load(path("saved.map")).origin().segmentation, segmentation));
  EXPECT_TRUE(bytesOf(WeightedVoxelMap::load(path("saved.map"))) == bytes);
}

TEST_F(MapFile, OfVersion1IsReadAndDoesNotTellHowItWasMade) {
  SegmentationOptions segmentation;
  WeightedMapBuilder builder(1.0, segmentation);
  addCloud(builder, mixedCloud(1, 5000, 90.0F), Eigen::Isometry3d::Identity());
  const WeightedVoxelMap map = builder.build();
  const std::string file = folder.write("old.map", asVersion1(bytesOf(map))).string();
  const WeightedVoxelMap loaded = WeightedVoxelMap::load(file);
  EXPECT_FALSE(loaded.origin().segmentation);
  EXPECT_EQ(loaded.origin().software_version, "");
  EXPECT_TRUE(loaded.labelled());
  EXPECT_EQ(loaded.entries().size(), map.entries().size());
  expectEqualTargets(NdtTarget::load(file), NdtTarget(map));
}

TEST_F(MapFile, OfVersion2IsReadAndDoesNotTellScans) {
  WeightedMapBuilder builder(1.0);
  for (unsigned seed = 0; seed < 3; ++seed) addCloud(builder, mixedCloud(seed, 5000), Eigen::Isometry3d::Identity());
  const WeightedVoxelMap map = builder.build();
  const WeightedVoxelMap loaded = WeightedVoxelMap::load(folder.write("old.map", asVersion2(bytesOf(map))).string());
  EXPECT_EQ(loaded.origin().software_version, SAW_NDT_VERSION);
  ASSERT_EQ(loaded.entries().size(), map.entries().size());
  for (std::size_t i = 0; i < map.entries().size(); ++i) {
    EXPECT_GT(map.entries()[i].scan_count, 0U);
    EXPECT_EQ(loaded.entries()[i].scan_count, 0U);
    EXPECT_EQ(loaded.entries()[i].sums, map.entries()[i].sums);
  }
}

TEST_F(MapFile, RefusesMoreScansOfAVoxelThanOfTheMap) {
  std::string damaged = bytesOf(tinyMap());
  const std::size_t first_entry = damaged.size() - 2 * kEntryBytes;
  damaged[first_entry + 9] = 2;
  checksum(damaged);
  expectRefused(damaged, {"offset " + std::to_string(first_entry), "out of range"});
}

TEST_F(MapFile, RefusesDamagedMetadata) {
  const std::string whole = bytesOf(tinyMap());
  const auto expectRefusedWith = [&](const std::string& from, const std::string& to, std::size_t offset,
                                     const std::string& reason) {
    std::string damaged = whole;
    damaged.replace(damaged.find(from), from.size(), to);
    checksumFront(damaged);
    expectRefused(damaged, {"offset " + std::to_string(offset), reason});
  };
  const std::size_t second_line = whole.find("segmentation = ");
  expectRefusedWith("segmentation = none", "segmentation = nine", second_line + 15, "no valid segmentation");
  expectRefusedWith("segmentation = none", "segmentotion = none", 96, "does not give segmentation");
  expectRefusedWith("segmentation = none", "segmentation : none", second_line, "key = value");
  expectRefusedWith("segmentation = none", "segmentation =known", second_line, "key = value");
  for (const std::uint32_t size : {0U, 1U, 0xFFFFFFFFU}) {
    std::string damaged = whole;
    put(damaged, 68, size);
    put(damaged, 92, crc32(damaged.substr(0, 92)));
    expectRefused(damaged, {"offset ", "do not make this size"});
  }
}

TEST_F(MapFile, AnEmptyMapIsAMap) {
  WeightedMapBuilder(2.0).build().save(path());
  const WeightedVoxelMap map = WeightedVoxelMap::load(path());
  EXPECT_TRUE(map.entries().empty());
  EXPECT_EQ(map.resolution(), 2.0);
  EXPECT_TRUE(NdtTarget::load(path()).empty());
}

TEST_F(MapFile, RefusesEveryTruncation) {
  for (const std::string& whole : allVersionsOf(mapOf(mixedCloud(1, 12)))) {
    for (std::size_t size = 0; size < whole.size(); ++size) {
      expectRefused(whole.substr(0, size), {"offset "});
    }
    expectRefused(whole + "x", {"offset ", "truncated or damaged"});
    expectRefused(whole + whole, {"offset "});
  }
}

TEST_F(MapFile, RefusesEveryDamagedByte) {
  for (const std::string& whole : allVersionsOf(tinyMap())) {
    for (std::size_t i = 0; i < whole.size(); ++i) {
      for (const char flip : {'\x01', '\x80', '\xFF'}) {
        std::string damaged = whole;
        damaged[i] = static_cast<char>(damaged[i] ^ flip);
        SCOPED_TRACE("byte " + std::to_string(i));
        expectRefused(damaged, {"offset "});
      }
    }
  }
}

TEST_F(MapFile, RefusesForeignFiles) {
  expectRefused("", {"offset 0", "too short"});
  expectRefused("SAWNDTM", {"offset 0", "too short"});
  expectRefused(std::string(1000, '\0'), {"offset 0", "not a saw_ndt map"});
  expectRefused("# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\n", {"offset 0", "not a saw_ndt map"});
  std::string newer = bytesOf(tinyMap());
  put(newer, 8, std::uint32_t{5});
  checksum(newer);
  expectRefused(newer, {"offset 8", "map version 5, this program reads versions 1 to 4"});
  expectThrows<Error>([&] { WeightedVoxelMap::load(path("none.map")); }, {path("none.map"), "No such file"});
  expectThrows<Error>([&] { WeightedVoxelMap::load(folder.path().string()); }, {folder.path().string(), "folder"});
}

TEST_F(MapFile, RefusesAbsurdSizesBeforeAllocating) {
  constexpr auto kHuge = std::numeric_limits<std::uint64_t>::max();
  const struct {
    std::size_t offset;  // of a u64, in a file without metadata
    std::uint64_t value;
    std::string reason;
  } cases[] = {
      {48, kHuge, "do not make this size"},  // entries
      {48, 1ULL << 40, "do not make this size"},
      {48, 3, "do not make this size"},
      {56, kHuge, "do not make this size"},                   // tiles
      {56, kHuge / kTileBytes + 1, "do not make this size"},  // wraps around when multiplied
      {56, 0, "do not make this size"},
      {112, kHuge, "does not follow"},  // entries of the tile
      {112, kHuge / kEntryBytes + 1, "does not follow"},
      {112, 1, "disagree"},
      {120, kHuge, "does not follow"},  // its offset
      {120, 0, "does not follow"},
      {140, 0, "out of range"},  // points of an entry
      {140, 3, "out of range"},  // more than the map has
      {140, 2, "the number of points"},
      {148, 32769, "out of range"},  // sum of a point more than half a voxel out
      {148, 1ULL << 63, "out of range"},
      {172, (1ULL << 30) + 1, "out of range"},  // its product
      {172, kHuge >> 1, "out of range"},
      {140, kHuge, "out of range"},
  };
  for (const std::string& whole : allVersionsOf(tinyMap())) {
    const std::size_t metadata = directoryOf(whole) - kHeaderBytes;
    for (const auto& c : cases) {
      std::string damaged = whole;
      put(damaged, c.offset < kHeaderBytes ? c.offset : c.offset + metadata, c.value);
      checksum(damaged);
      SCOPED_TRACE(std::to_string(c.offset) + " = " + std::to_string(c.value));
      expectRefused(damaged, {"offset ", c.reason});
    }
  }
}

TEST_F(MapFile, RefusesAnotherLayout) {
  const std::vector<std::string> versions = allVersionsOf(tinyMap());
  const auto expectRefusedWith = [&](std::size_t offset, auto value, const std::string& reason) {
    for (std::string damaged : versions) {
      put(damaged, offset < kHeaderBytes ? offset : offset + directoryOf(damaged) - kHeaderBytes, value);
      checksum(damaged);
      SCOPED_TRACE(offset);
      expectRefused(damaged, {"offset ", reason});
    }
  };
  expectRefusedWith(12, std::uint32_t{128}, "unknown layout");  // header bytes
  expectRefusedWith(24, std::uint32_t{32}, "unknown layout");   // tile size
  expectRefusedWith(28, std::uint32_t{3}, "unknown layout");    // flags
  expectRefusedWith(16, 0.0, "resolution");
  expectRefusedWith(16, -1.0, "resolution");
  expectRefusedWith(16, std::nan(""), "resolution");
  expectRefusedWith(16, std::numeric_limits<double>::infinity(), "resolution");
  expectRefusedWith(96, std::int32_t{1 << 25}, "outside");  // tile coordinates
  expectRefusedWith(104, std::numeric_limits<std::int32_t>::min(), "outside");
  expectRefusedWith(136, std::uint8_t{64}, "out of range");  // place in the tile
  expectRefusedWith(139, std::uint8_t{3}, "out of range");   // label
  expectRefusedWith(139, std::uint8_t{2}, "out of order");   // the same as the next one
}

TEST_F(MapFile, RefusesTilesOutOfOrder) {
  std::vector<LabelledVoxelSums> entries;
  for (const int x : {0, 64}) {
    LabelledVoxelSums& entry = entries.emplace_back();
    entry.voxel = {x, 0, 0};
    entry.sums.add({1, 2, 3});
  }
  MapOrigin origin;
  origin.point_count = 2;
  for (std::string bytes : allVersionsOf(WeightedVoxelMap(origin, entries))) {
    const std::size_t directory = directoryOf(bytes);
    for (const std::int32_t x : {1, 2}) {  // of the first tile; that of the second one is 1
      put(bytes, directory, x);
      put(bytes, 64, crc32(bytes.substr(directory, 2 * kTileBytes)));
      put(bytes, 92, crc32(bytes.substr(0, 92)));
      expectRefused(bytes, {"offset " + std::to_string(directory + kTileBytes), "out of order"});
    }
  }
}

TEST_F(MapFile, TellsTheOriginOfTheMapWhereItIsNotZero) {
  const std::string without = bytesOf(tinyMap());
  WeightedMapBuilder builder(1.0);
  builder.setMapOrigin({0.0, -0.0, 0.0});
  builder.merge(tinyMap());
  EXPECT_TRUE(bytesOf(builder.build()) == without);
  EXPECT_EQ(WeightedVoxelMap::load(path("saved.map")).origin().map_origin_m, Eigen::Vector3d::Zero());

  MapOrigin origin = tinyMap().origin();
  origin.map_origin_m << 691000.1, 5335999.0 + 1e-9, -0.1;
  const std::string with = bytesOf({origin, tinyMap().entries()});
  EXPECT_EQ(WeightedVoxelMap::load(path("saved.map")).origin().map_origin_m, origin.map_origin_m);
  EXPECT_EQ(NdtTarget::load(path("saved.map")).origin().map_origin_m, origin.map_origin_m);
  for (const std::string to : {"inf", "1 2", "1 2 3 4", "1 2 x", ""}) {
    std::string damaged = with;
    const std::size_t begin = damaged.find("map_origin_m = ") + 15, end = damaged.find('\n', begin);
    damaged.replace(begin, end - begin, to + std::string(end - begin > to.size() ? end - begin - to.size() : 0, ' '));
    ASSERT_EQ(damaged.size(), with.size());
    checksumFront(damaged);
    expectRefused(damaged, {"offset " + std::to_string(begin), "no valid map_origin_m"});
  }
  origin.map_origin_m.x() = std::nan("");
  expectThrows<std::invalid_argument>([&] { WeightedVoxelMap(origin, {}); }, {"map_origin_m", "finite"});
  expectThrows<std::invalid_argument>([&] { builder.setMapOrigin(origin.map_origin_m); }, {"map_origin_m", "finite"});
}

TEST_F(MapFile, LeavesNothingBehindWhereItCannotWrite) {
  const WeightedVoxelMap map = tinyMap();
  expectThrows<Error>([&] { map.save(path("none/a.map")); }, {path("none/a.map"), "No such file"});
  expectThrows<Error>([&] { map.save(folder.path().string()); }, {folder.path().string()});
  EXPECT_EQ(folder.entryCount(), 0U);
  folder.write("a.map", "older");
  map.save(path());
  EXPECT_EQ(folder.entryCount(), 1U);
  EXPECT_GT(std::filesystem::file_size(path()), 5U);
  if (std::filesystem::exists("/dev/full")) {
    expectThrows<Error>([&] { map.save("/dev/full"); }, {"/dev/full"});
  }
}

TEST_F(MapFile, EntriesAreOrderedByTileThenVoxelThenLabel) {
  const auto entry = [](int x, int y, int z, StructuralLabel label) { return LabelledVoxelSums{{x, y, z}, label, {}}; };
  const std::vector<LabelledVoxelSums> ordered{
      entry(-1, 0, 0, StructuralLabel::GROUND), entry(63, 0, 0, StructuralLabel::NOISE),
      entry(63, 0, 0, StructuralLabel::GROUND), entry(0, 1, 0, StructuralLabel::NOISE),
      entry(0, 0, 1, StructuralLabel::NOISE),   entry(64, 0, 0, StructuralLabel::NOISE),
      entry(0, 64, 0, StructuralLabel::NOISE),  entry(-65, -65, 64, StructuralLabel::NOISE),
  };
  for (std::size_t i = 0; i < ordered.size(); ++i) {
    for (std::size_t j = 0; j < ordered.size(); ++j)
      EXPECT_EQ(inMapOrder(ordered[i], ordered[j]), i < j) << i << ' ' << j;
  }
  EXPECT_EQ(tileOf({-1, -64, -65}), Eigen::Vector3i(-1, -1, -2));
}

}  // namespace
}  // namespace saw_ndt
