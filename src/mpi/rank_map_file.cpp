#include "mpi/rank_map_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <boost/mpi/collectives.hpp>
#include <boost/serialization/string.hpp>
#include <cerrno>
#include <cstring>
#include <numeric>
#include <optional>
#include <vector>

#include "common/atomic_output.h"
#include "common/unfinished_output.h"
#include "common/write_at.h"
#include "map/map_encoding.h"
#include "map/map_tile.h"
#include "map/sums_statistics.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {
namespace {

namespace mpi = boost::mpi;

/// A file that several processes write parts of.
class SharedFile {
 public:
  SharedFile(const std::string& path, const std::string& target)
      : target_(target), descriptor_(open(path.c_str(), O_WRONLY | O_CLOEXEC)) {
    if (descriptor_ < 0) fail(" (the folder of the map must be one that all ranks see)");
  }
  ~SharedFile() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  SharedFile(const SharedFile&) = delete;
  SharedFile& operator=(const SharedFile&) = delete;

  void write(const std::vector<char>& bytes, std::uint64_t offset) {
    if (!writeAt(descriptor_, offset, bytes.data(), bytes.size())) fail();
  }
  // What was written is in the file system, where others find it, or this throws.
  void finish() {
    const int failure = close(descriptor_);
    descriptor_ = -1;
    if (failure != 0) fail();
  }

 private:
  [[noreturn]] void fail(const std::string& hint = "") const { throw Error(target_, "", std::strerror(errno) + hint); }

  std::string target_;
  int descriptor_;
};

/// What the directory tells of a tile but for its offset, as numbers for MPI.
struct PackedRecord {
  static constexpr std::size_t kNumbers = 3;

  static void append(const MapTileRecord& tile, std::vector<std::uint64_t>& numbers) {
    const auto half = [](int value) { return std::uint64_t{static_cast<std::uint32_t>(value)}; };
    numbers.push_back(half(tile.coordinate.x()) << 32U | half(tile.coordinate.y()));
    numbers.push_back(half(tile.coordinate.z()) << 32U | tile.checksum);
    numbers.push_back(tile.entry_count);
  }
  static MapTileRecord at(const std::uint64_t* numbers) {
    const auto upper = [](std::uint64_t number) { return static_cast<int>(static_cast<std::uint32_t>(number >> 32U)); };
    const auto lower = [](std::uint64_t number) { return static_cast<std::uint32_t>(number); };
    MapTileRecord tile;
    tile.coordinate = {upper(numbers[0]), static_cast<int>(lower(numbers[0])), upper(numbers[1])};
    tile.checksum = lower(numbers[1]);
    tile.entry_count = numbers[2];
    return tile;
  }
};

/// Where the tiles of all ranks stand in the file.
struct FilePlan {
  std::vector<int> tile_counts;        // of each rank
  std::vector<std::uint64_t> offsets;  // of the tiles, rank after rank
  std::vector<MapTileRecord> records;  // in map order
};

// On rank 0; nothing on the others.
FilePlan gatherPlan(const mpi::communicator& ranks, const std::vector<std::uint64_t>& own, const MapOrigin& origin) {
  FilePlan plan;
  const auto own_count = static_cast<int>(own.size());
  if (ranks.rank() != 0) {
    mpi::gather(ranks, own_count, 0);
    mpi::gatherv(ranks, own.data(), own_count, 0);
    return plan;
  }
  std::vector<int> counts;
  mpi::gather(ranks, own_count, counts, 0);
  std::vector<std::uint64_t> numbers(std::accumulate(counts.begin(), counts.end(), std::size_t{0}));
  mpi::gatherv(ranks, own.data(), own_count, numbers.data(), counts, 0);
  for (const int count : counts) plan.tile_counts.push_back(count / static_cast<int>(PackedRecord::kNumbers));

  const std::size_t tile_count = numbers.size() / PackedRecord::kNumbers;
  std::vector<std::pair<MapTileRecord, std::size_t>> tiles;  // with their number, rank after rank
  tiles.reserve(tile_count);
  for (std::size_t i = 0; i < tile_count; ++i) {
    tiles.emplace_back(PackedRecord::at(&numbers[i * PackedRecord::kNumbers]), i);
  }
  std::sort(tiles.begin(), tiles.end(),
            [](const auto& a, const auto& b) { return tileInMapOrder(a.first.coordinate, b.first.coordinate); });
  plan.offsets.resize(tile_count);
  plan.records.reserve(tile_count);
  std::uint64_t offset = bytesOfFront(origin, tile_count);
  for (auto& [record, number] : tiles) {
    record.offset = plan.offsets[number] = offset;
    offset += bytesOfEntries(record.entry_count);
    plan.records.push_back(record);
  }
  return plan;
}

std::vector<std::uint64_t> scatterOffsets(const mpi::communicator& ranks, const FilePlan& plan, std::size_t own_count) {
  std::vector<std::uint64_t> own(own_count);
  const auto size = static_cast<int>(own_count);
  if (ranks.rank() == 0) {
    mpi::scatterv(ranks, plan.offsets, plan.tile_counts, own.data(), 0);
  } else {
    mpi::scatterv(ranks, own.data(), size, 0);
  }
  return own;
}

}  // namespace

std::uint64_t writeMapOfRanks(const mpi::communicator& ranks, const std::string& path, const MapOfRanks& map) {
  std::vector<std::uint64_t> own;
  std::vector<char> bytes;
  std::uint64_t voxel_count = 0;
  map.owned.forEachTile([&](const std::vector<LabelledVoxelSums>& entries) {
    voxel_count += voxelCountOf(entries.data(), entries.data() + entries.size(), map.owned.origin().resolution_m);
    PackedRecord::append(encodeTile(entries.data(), entries.data() + entries.size(), bytes), own);
  });
  const FilePlan plan = gatherPlan(ranks, own, map.origin);
  const std::vector<std::uint64_t> offsets = scatterOffsets(ranks, plan, own.size() / PackedRecord::kNumbers);

  std::optional<AtomicOutput> output;
  std::string temporary;
  if (ranks.rank() == 0) temporary = std::filesystem::absolute(output.emplace(path).temporary()).string();
  mpi::broadcast(ranks, temporary, 0);
  // Where rank 0 has died, launchers end the others by SIGTERM.
  std::optional<UnfinishedOutput> of_rank_0;
  if (!output) of_rank_0.emplace([&] { return temporary; });
  SharedFile file(temporary, path);
  std::size_t tile = 0;
  map.owned.forEachTile([&](const std::vector<LabelledVoxelSums>& entries) {
    encodeTile(entries.data(), entries.data() + entries.size(), bytes);
    file.write(bytes, offsets[tile++]);
  });
  file.finish();
  ranks.barrier();
  if (output) {
    const std::string front = encodeFront(map.origin, plan.records);
    output->stream().write(front.data(), static_cast<std::streamsize>(front.size()));
    output->commit();
  }
  ranks.barrier();
  if (of_rank_0) of_rank_0->finish();
  return voxel_count;
}

}  // namespace saw_ndt::internal
