#include "saw_ndt/map/map_update.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstring>
#include <map>
#include <random>
#include <thread>
#include <vector>

#include "common/growing_file.h"
#include "expect_throws.h"
#include "map/map_file.h"
#include "map/map_file_layout.h"
#include "map_file_bytes.h"
#include "map_fixtures.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/map/map_merge.h"
#include "temporary_folder.h"

namespace saw_ndt {

using namespace internal;

namespace {

class MapUpdateInPlace : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder.path() / name).string(); }
  std::string saved(const std::string& name, const WeightedVoxelMap& map) const {
    map.save(path(name));
    return path(name);
  }
  std::string bytesOf(const WeightedVoxelMap& map) const { return contentOf(saved("bytes.map", map)); }

  /// A map of one scan of what lies within an extent; the whole town is one of some 9 x 9 tiles.
  static WeightedVoxelMap drive(unsigned scan, float extent_m = 10.0F, int points = 1500, double resolution_m = 0.4) {
    WeightedMapBuilder builder(resolution_m, SegmentationOptions());
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation() << 40.0 * scan, -25.0 * scan, 0.0;
    addCloud(builder, mixedCloud(scan, points, extent_m), T);
    return builder.build();
  }
  static WeightedVoxelMap town() { return drive(0, 110.0F, 6000); }

  /// Whether two maps have the same file.
  static bool same(const WeightedVoxelMap& a, const WeightedVoxelMap& b) {
    const auto same_entry = [](const LabelledVoxelSums& x, const LabelledVoxelSums& y) {
      return x.voxel == y.voxel && x.label == y.label && x.sums == y.sums && x.scan_count == y.scan_count;
    };
    return a.origin().scan_count == b.origin().scan_count && a.origin().point_count == b.origin().point_count &&
           a.origin().software_version == b.origin().software_version &&
           std::equal(a.entries().begin(), a.entries().end(), b.entries().begin(), b.entries().end(), same_entry);
  }

  MapHeaderLayout headerOf(const std::string& bytes) const {
    MapHeaderLayout header;
    std::memcpy(&header, bytes.data(), sizeof header);
    return header;
  }

  TemporaryFolder folder;
};

TEST_F(MapUpdateInPlace, GivesTheMapThatMergingGives) {
  const std::string map = saved("town.map", town());
  std::vector<std::string> paths = {map};
  std::string merged = bytesOf(WeightedVoxelMap::load(map));
  for (const unsigned scan : {1U, 2U, 3U, 9U}) {  // the last one lies outside
    const std::string before = contentOf(map);
    const std::string added = saved("drive.map", drive(scan));
    mergeMapFiles({saved("before.map", WeightedVoxelMap::load(map)), added}, path("merged.map"));
    merged = contentOf(path("merged.map"));
    const MapUpdate update = updateMapFile(map, {added}, 2);
    EXPECT_TRUE(bytesOf(WeightedVoxelMap::load(map)) == merged);
    expectEqualTargets(NdtTarget::load(map), NdtTarget::load(path("merged.map")));
    EXPECT_EQ(mergeMapFiles({map}, path("compact.map")).dead_bytes_left_out, deadBytesOfMapFile(map));
    EXPECT_TRUE(contentOf(path("compact.map")) == merged);

    // What was there stays, and what is new is told to the byte.
    const std::string after = contentOf(map);
    EXPECT_TRUE(after.compare(96, before.size() - 96, before, 96) == 0);
    EXPECT_EQ(update.file_bytes, after.size());
    EXPECT_EQ(update.bytes_appended, after.size() - before.size());
    EXPECT_EQ(update.dead_bytes, after.size() - merged.size());
    EXPECT_EQ(deadBytesOfMapFile(map), update.dead_bytes);
    EXPECT_EQ(update.tiles_met, MapFileReader(added).tileCount());
    EXPECT_EQ(update.tiles_new, MapFileReader(map).tileCount() - MapFileReader(path("before.map")).tileCount());
    EXPECT_EQ(update.origin.scan_count, WeightedVoxelMap::load(map).origin().scan_count);
    EXPECT_EQ(headerOf(after).version.value(), 4U);
  }
  EXPECT_GT(deadBytesOfMapFile(map), 0U);
  EXPECT_EQ(folder.entryCount(), 6U);
}

TEST_F(MapUpdateInPlace, AddsSeveralMapsAtOnceByAnyNumberOfThreads) {
  const std::string a = saved("a.map", drive(1)), b = saved("b.map", drive(2, 30.0F)),
                    empty = saved("empty.map", WeightedMapBuilder(0.4, SegmentationOptions()).build());
  const std::string town_file = saved("town.map", town());
  const std::string expected = bytesOf(mergeMapFiles({town_file, a, b}));
  const std::string one = saved("one.map", town()), two = saved("two.map", town());
  updateMapFile(one, {a, b, empty}, 1);
  updateMapFile(two, {b, empty, a}, 2);
  EXPECT_TRUE(contentOf(one) == contentOf(two));
  EXPECT_TRUE(bytesOf(WeightedVoxelMap::load(one)) == expected);
}

TEST_F(MapUpdateInPlace, ChangesNothingWhereNothingIsAdded) {
  const std::string map = saved("town.map", town());
  const std::string before = contentOf(map);
  const MapUpdate update =
      updateMapFile(map, {saved("empty.map", WeightedMapBuilder(0.4, SegmentationOptions()).build())});
  EXPECT_EQ(update.tiles_met, 0U);
  EXPECT_EQ(update.origin.scan_count, 1U);
  EXPECT_TRUE(contentOf(map) == before);
}

TEST_F(MapUpdateInPlace, UpdatesAnEmptyMap) {
  const std::string map = saved("empty.map", WeightedMapBuilder(0.4, SegmentationOptions()).build());
  const MapUpdate update = updateMapFile(map, {saved("a.map", drive(1))});
  EXPECT_EQ(update.tiles_new, update.tiles_met);
  EXPECT_TRUE(bytesOf(WeightedVoxelMap::load(map)) == contentOf(path("a.map")));
}

TEST_F(MapUpdateInPlace, WhoHasItOpenReadsTheOldMap) {
  const std::string map = saved("town.map", town());
  const std::string old_bytes = contentOf(map);
  MapFileReader reader(map);
  updateMapFile(map, {saved("a.map", drive(1, 60.0F))});
  std::vector<LabelledVoxelSums> entries, of_tile;
  for (std::uint64_t tile = 0; tile < reader.tileCount(); ++tile) {
    reader.decodeTile(tile, of_tile);
    entries.insert(entries.end(), of_tile.begin(), of_tile.end());
  }
  EXPECT_TRUE(bytesOf({reader.origin(), entries}) == old_bytes);
}

TEST_F(MapUpdateInPlace, BrokenOffAnywhereItIsTheOldMap) {
  const std::string map = saved("town.map", drive(0, 30.0F, 400));
  const WeightedVoxelMap old_map = WeightedVoxelMap::load(map);
  const std::string old_bytes = contentOf(map), added = saved("a.map", drive(1, 30.0F, 200));
  updateMapFile(map, {added});
  const std::string new_bytes = contentOf(map);
  // The header as it is while tiles are appended.
  MapHeaderLayout header = headerOf(old_bytes);
  header.version = 4;
  header.front_offset = sizeof header;
  header.end_offset = old_bytes.size();
  header.checksum = checksumOf(&header, sizeof header - 4);
  const std::string begun(reinterpret_cast<const char*>(&header), sizeof header);

  std::mt19937 random(1);
  for (std::size_t size = old_bytes.size(); size <= new_bytes.size(); size += size + 150 < new_bytes.size() ? 149 : 1) {
    std::string state = begun + new_bytes.substr(96, size - 96);
    folder.writeAnew("state.map", state);
    ASSERT_TRUE(same(WeightedVoxelMap::load(path("state.map")), old_map)) << size;
    ASSERT_EQ(deadBytesOfMapFile(path("state.map")), size - old_bytes.size());
    // After a loss of power what had not reached the disk may be anything.
    for (std::size_t i = old_bytes.size(); i < size; ++i) state[i] = static_cast<char>(random());
    folder.writeAnew("state.map", state);
    ASSERT_TRUE(same(WeightedVoxelMap::load(path("state.map")), old_map)) << size;
  }
  // The rest of it is overwritten by the next one, however long it is.
  for (const std::size_t rest : {std::size_t{1}, new_bytes.size(), 2 * new_bytes.size()}) {
    folder.writeAnew("state.map", begun + old_bytes.substr(96) + std::string(rest, 'x'));
    updateMapFile(path("state.map"), {added});
    EXPECT_TRUE(contentOf(path("state.map")) == new_bytes);
  }
}

TEST_F(MapUpdateInPlace, KilledAtAnyMomentItIsTheOldMapOrTheNewOne) {
  const std::string first = saved("first.map", town()), map = path("town.map");
  const std::string added = saved("a.map", drive(1, 60.0F, 4000));
  const std::string old_map = contentOf(first), new_map = bytesOf(mergeMapFiles({first, added}));
  std::mt19937 random(7);
  // How long one takes, so that kills fall into all of it.
  std::filesystem::copy_file(first, map);
  const auto start = std::chrono::steady_clock::now();
  updateMapFile(map, {added}, 1);
  const auto duration = std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - start);
  for (int trial = 0; trial < 40; ++trial) {
    std::filesystem::copy_file(first, map, std::filesystem::copy_options::overwrite_existing);
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      updateMapFile(map, {added}, 1);
      _exit(0);
    }
    std::this_thread::sleep_for(std::chrono::microseconds(random() % (1 + 3 * duration.count() / 2)));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    const std::string left = bytesOf(WeightedVoxelMap::load(map));
    ASSERT_TRUE(left == old_map || left == new_map) << trial;
    if (left == new_map) continue;
    updateMapFile(map, {added}, 1);
    ASSERT_TRUE(bytesOf(WeightedVoxelMap::load(map)) == new_map) << trial;
  }
}

TEST_F(MapUpdateInPlace, ReadersMeanwhileReadOneOfTheMaps) {
  const std::string map = saved("town.map", town());
  std::map<std::uint64_t, std::string> maps;  // by their scans
  std::vector<std::string> added = {map};
  for (unsigned scan = 1; scan <= 12; ++scan) {
    added.push_back(saved("drive" + std::to_string(scan) + ".map", drive(scan % 4, 50.0F)));
  }
  for (std::size_t count = 1; count <= added.size(); ++count) {
    const WeightedVoxelMap merged = mergeMapFiles({added.begin(), added.begin() + static_cast<std::ptrdiff_t>(count)});
    maps[merged.origin().scan_count] = bytesOf(merged);
  }
  std::atomic<bool> done{false};
  int read = 0;
  std::thread reader([&] {
    while (!done) {
      const WeightedVoxelMap loaded = WeightedVoxelMap::load(map);
      loaded.save(path("read.map"));
      ASSERT_TRUE(contentOf(path("read.map")) == maps.at(loaded.origin().scan_count));
      ++read;
    }
  });
  for (std::size_t i = 1; i < added.size(); ++i) updateMapFile(map, {added[i]}, 1);
  done = true;
  reader.join();
  EXPECT_GT(read, 0);
  EXPECT_TRUE(bytesOf(WeightedVoxelMap::load(map)) == maps.at(added.size()));
}

TEST_F(MapUpdateInPlace, DamageIsRefusedOrIsOfDeadBytes) {
  const std::string map = saved("town.map", mapOf(mixedCloud(0, 16), 0.4));
  updateMapFile(map, {saved("a.map", mapOf(mixedCloud(0, 8), 0.4))});
  const std::string whole = contentOf(map);
  const WeightedVoxelMap meant = WeightedVoxelMap::load(map);
  const std::uint64_t dead_bytes = deadBytesOfMapFile(map);
  std::uint64_t without_effect = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    for (const char flip : {'\x01', '\xFF'}) {
      std::string damaged = whole;
      damaged[i] = static_cast<char>(damaged[i] ^ flip);
      folder.writeAnew("damaged.map", damaged);
      try {
        ASSERT_TRUE(same(WeightedVoxelMap::load(path("damaged.map")), meant)) << i;
        ++without_effect;
      } catch (const Error& error) {
        ASSERT_NE(std::string(error.what()).find("damaged.map: offset "), std::string::npos) << error.what();
      }
    }
  }
  EXPECT_EQ(without_effect, 2 * dead_bytes);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    folder.writeAnew("damaged.map", whole.substr(0, size));
    expectThrows<Error>([&] { WeightedVoxelMap::load(path("damaged.map")); }, {"damaged.map: offset "});
    expectThrows<Error>([&] { NdtTarget::load(path("damaged.map")); }, {"damaged.map: offset "});
    expectThrows<Error>([&] { updateMapFile(path("damaged.map"), {path("a.map")}); }, {"damaged.map: offset "});
  }
}

TEST_F(MapUpdateInPlace, RefusesAHeaderThatPointsAnywhere) {
  const std::string map = saved("town.map", mapOf(mixedCloud(0, 16), 0.4));
  updateMapFile(map, {saved("a.map", mapOf(mixedCloud(0, 8), 0.4))});
  const std::string whole = contentOf(map);
  const auto expectRefused = [&](auto change, const std::string& reason) {
    MapHeaderLayout header = headerOf(whole);
    change(header);
    header.checksum = checksumOf(&header, sizeof header - 4);
    folder.writeAnew("damaged.map",
                     std::string(reinterpret_cast<const char*>(&header), sizeof header) + whole.substr(sizeof header));
    expectThrows<Error>([&] { WeightedVoxelMap::load(path("damaged.map")); }, {"damaged.map: offset ", reason});
  };
  for (const std::uint64_t offset :
       {std::uint64_t{0}, std::uint64_t{95}, std::uint64_t{whole.size() + 1}, ~std::uint64_t{0}}) {
    expectRefused([&](MapHeaderLayout& header) { header.front_offset = offset; }, "outside the map");
  }
  expectRefused([&](MapHeaderLayout& header) { header.front_offset = whole.size(); }, "do not make this size");
  expectRefused([&](MapHeaderLayout& header) { header.front_offset = 96; }, "checksum");
  expectRefused([&](MapHeaderLayout& header) { header.end_offset = whole.size() + 1; }, "truncated");
  expectRefused([&](MapHeaderLayout& header) { header.end_offset = ~std::uint64_t{0}; }, "truncated");
  expectRefused([&](MapHeaderLayout& header) { header.end_offset = 0; }, "outside the map");
  expectRefused([&](MapHeaderLayout& header) { header.entry_count = ~std::uint64_t{0}; }, "do not make this size");
  expectRefused([&](MapHeaderLayout& header) { header.tile_count = ~std::uint64_t{0} / 40 + 2; }, "do not make this");
}

TEST_F(MapUpdateInPlace, OfOlderVersionsIsDoneFromVersion2On) {
  const std::string bytes = bytesOf(town()), a = saved("a.map", drive(1));
  const std::string first = folder.write("1.map", asVersion1(bytes)).string();
  mergeMapFiles({first}, path("2.map"));
  expectThrows<Error>([&] { updateMapFile(first, {path("2.map")}); }, {"1.map: map version 1", "merge it"});
  EXPECT_TRUE(contentOf(first) == asVersion1(bytes));
  const std::string second = folder.write("2.map", asVersion2(bytes)).string();
  const std::string expected = bytesOf(mergeMapFiles({second, a}));
  updateMapFile(second, {a});
  EXPECT_TRUE(bytesOf(WeightedVoxelMap::load(second)) == expected);
}

TEST_F(MapUpdateInPlace, AMapThatDoesNotMergeLeavesEveryByte) {
  const std::string map = saved("town.map", town()), a = saved("a.map", drive(1));
  const std::string before = contentOf(map);
  std::string damaged = contentOf(a);
  damaged[damaged.size() - 5] = static_cast<char>(damaged[damaged.size() - 5] ^ 1);
  folder.writeAnew("damaged.map", damaged);
  saved("fine.map", drive(1, 10.0F, 100, 0.2));
  expectThrows<Error>([&] { updateMapFile(map, {path("fine.map")}); }, {"fine.map: does not merge with ", "town.map"});
  expectThrows<Error>([&] { updateMapFile(map, {a, path("damaged.map")}); }, {"damaged.map: offset ", "checksum"});
  expectThrows<Error>([&] { updateMapFile(map, {map}); }, {"town.map: is given twice"});
  expectThrows<Error>([&] { updateMapFile(map, {path("none.map")}); }, {"none.map: No such file"});
  expectThrows<Error>([&] { updateMapFile(path("none.map"), {a}); }, {"none.map: No such file"});
  expectThrows<Error>([&] { updateMapFile(folder.path().string(), {a}); }, {"Is a directory"});
  expectThrows<Error>([&] { updateMapFile("/dev/null", {a}); }, {"/dev/null: is no regular file"});
  expectThrows<std::invalid_argument>([&] { updateMapFile(map, {}); }, {"no map"});
  EXPECT_TRUE(contentOf(map) == before);
  {
    const GrowingFile other(map);
    expectThrows<Error>([&] { updateMapFile(map, {a}); }, {"town.map: is being changed by another process"});
  }
  updateMapFile(map, {a});
  const std::string after = contentOf(map);
  expectThrows<Error>([&] { updateMapFile(map, {path("damaged.map")}); }, {"damaged.map: offset "});
  EXPECT_TRUE(contentOf(map) == after);
}

}  // namespace
}  // namespace saw_ndt
