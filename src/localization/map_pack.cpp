#include "saw_ndt/localization/map_pack.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/executor.h"
#include "localization/place_index.h"
#include "localization/place_table.h"
#include "map/coarse_sums.h"
#include "map/level_plan.h"
#include "map/localization_map_writer.h"
#include "map/localization_tile.h"
#include "map/map_file.h"
#include "map/sums_statistics.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt {

using namespace internal;

namespace {

// Tiles along the edge of a block: what is packed at a time.
constexpr int kBlockTiles = 4;
// Ground is taken to go on so many tiles from where it is seen at most.
constexpr int kRingTiles = 1;

// Places within a tile have 16 bits.
constexpr double kLeastResolution_m = 0.001;

std::vector<LevelPlan> levelsOf(const TargetPlan& plan) {
  std::vector<LevelPlan> levels = plan.levels;
  if (plan.coarse) levels.push_back(*plan.coarse);
  return levels;
}

// Calls visit(entries) with one part after the other.
using EntriesInParts = std::function<void(const std::function<void(const std::vector<LabelledVoxelSums>&)>& visit)>;

// Packs blocks of tiles, each from the entries in it and around it.
class BlockPacker {
 public:
  BlockPacker(const MapOrigin& origin, const VoxelWeighting& weighting)
      : origin_(origin), weighting_(weighting), plan_(planTarget(origin, weighting)), levels_(levelsOf(plan_)) {
    for (const LevelPlan& level : levels_) resolutions_m_.push_back(level.resolution_m);
  }

  /// How far around a block entries are needed (m).
  double margin() const {
    const double largest_m = *std::max_element(resolutions_m_.begin(), resolutions_m_.end());
    return kRingTiles * kLocalizationTile_m + largest_m;
  }

  /// @param entries  those of the block and the margin around it, in map order and in parts of whole voxels
  std::vector<PackedTile> pack(const TileCoordinate& block, const EntriesInParts& entries) const {
    std::map<TileCoordinate, LocalizationTile> tiles = tilesAround(block, entries);
    std::map<TileCoordinate, PackedTile> packed;
    const auto packedAt = [&](const TileCoordinate& at) -> PackedTile& {
      const auto [found, is_new] = packed.try_emplace(at);
      if (is_new) {
        LocalizationTile none;
        none.levels.resize(levels_.size());
        found->second.at = at;
        found->second.cells = encodedTile(none, resolutions_m_);
      }
      return found->second;
    };
    std::vector<NdtCells> cells(levels_.size());
    for (auto& [at, tile] : tiles) {
      const std::string bytes = encodedTile(tile, resolutions_m_);
      appendDecodedTile(bytes.data(), bytes.size(), at, resolutions_m_, weighting_, {}, cells);
      if (!isIn(block, at, 0)) continue;
      PackedTile& of_tile = packedAt(at);
      of_tile.cells = bytes;
      of_tile.coarse_voxel_count = plan_.coarse ? tile.levels.back().cells.size() : 0;
      of_tile.voxel_count = tile.cellCount() - of_tile.coarse_voxel_count;
      tile.levels.clear();
    }
    // From the voxels as they will be read.
    std::vector<NdtLevel> read;
    for (std::size_t i = 0; i < cells.size(); ++i) read.emplace_back(resolutions_m_[i], std::move(cells[i]));
    const PlaceIndex index(NdtTarget::ofLevels(origin_, weighting_, std::move(read)));
    for (const PlaceIndex::Tile& tile : index.tiles()) {
      const TileCoordinate at{tile.at.x, tile.at.y};
      if (isIn(block, at, 0)) packedAt(at).table = encodedPlaceTile(tile);
    }
    std::vector<PackedTile> in_order;
    for (auto& [at, tile] : packed) in_order.push_back(std::move(tile));
    return in_order;
  }

 private:
  static bool isIn(const TileCoordinate& block, const TileCoordinate& tile, int ring) {
    const auto within = [ring](int block_at, int at) {
      return at >= block_at * kBlockTiles - ring && at < (block_at + 1) * kBlockTiles + ring;
    };
    return within(block.x, tile.x) && within(block.y, tile.y);
  }

  std::map<TileCoordinate, LocalizationTile> tilesAround(const TileCoordinate& block,
                                                         const EntriesInParts& entries) const {
    std::map<TileCoordinate, LocalizationTile> tiles;
    const auto add = [&](std::size_t i, const std::vector<LabelledVoxelSums>& of_level) {
      const auto add_batch = [&](const std::vector<VoxelStatistics>& statistics) {
        for (const VoxelStatistics& voxel : statistics) {
          const TileCoordinate at = localizationTileOf(voxel.voxel, resolutions_m_[i]);
          if (!isIn(block, at, kRingTiles)) continue;
          LocalizationTile& tile = tiles[at];
          tile.at = at;
          tile.levels.resize(levels_.size());
          tile.add(i, voxel, resolutions_m_[i]);
        }
      };
      forEachStatistics(of_level.data(), of_level.data() + of_level.size(), weighting_, levels_[i],
                        origin_.resolution_m / kStepsPerVoxel, add_batch);
    };
    std::map<std::size_t, CoarseSums> larger;
    for (std::size_t i = 0; i < levels_.size(); ++i) {
      if (levels_[i].factor > 1) larger.emplace(i, levels_[i].factor);
    }
    entries([&](const std::vector<LabelledVoxelSums>& part) {
      for (std::size_t i = 0; i < levels_.size(); ++i) {
        if (levels_[i].factor == 1) {
          add(i, part);
        } else {
          larger.at(i).add(part.data(), part.data() + part.size());
        }
      }
    });
    for (auto& [level, sums] : larger) add(level, sums.takeInMapOrder());
    return tiles;
  }

  MapOrigin origin_;
  VoxelWeighting weighting_;
  TargetPlan plan_;
  std::vector<LevelPlan> levels_;
  std::vector<double> resolutions_m_;
};

// The entries of a map file around blocks of tiles. Of the file only the tiles that a block needs are in memory.
class EntriesAroundBlocks {
 public:
  EntriesAroundBlocks(MapFileReader& reader, double margin_m) : reader_(reader) {
    const double resolution_m = reader.origin().resolution_m;
    for (std::uint64_t place = 0; place < reader.tileCount(); ++place) {
      const Eigen::Vector2d least_m =
          reader.front().tile(place).coordinate.head<2>().cast<double>() * kTileSize * resolution_m;
      const auto blockAt = [](double position_m) {
        return static_cast<int>(std::floor(position_m / (kBlockTiles * kLocalizationTile_m)));
      };
      const double end_m = kTileSize * resolution_m + margin_m;
      for (int y = blockAt(least_m.y() - margin_m); y <= blockAt(least_m.y() + end_m); ++y) {
        for (int x = blockAt(least_m.x() - margin_m); x <= blockAt(least_m.x() + end_m); ++x) {
          tiles_of_block_[{x, y}].push_back(place);
        }
      }
    }
  }

  std::vector<TileCoordinate> blocks() const {
    std::vector<TileCoordinate> blocks;
    for (const auto& [block, tiles] : tiles_of_block_) blocks.push_back(block);
    return blocks;
  }

  // Tile after tile.
  EntriesInParts around(const TileCoordinate& block) const {
    return [this, &tiles = tiles_of_block_.at(block)](const auto& visit) {
      std::vector<LabelledVoxelSums> entries;
      for (const std::uint64_t place : tiles) {
        reader_.decodeTile(place, entries);
        reader_.forget(reader_.front().tile(place));
        visit(entries);
      }
    };
  }

 private:
  MapFileReader& reader_;
  std::map<TileCoordinate, std::vector<std::uint64_t>> tiles_of_block_;
};

}  // namespace

void packMap(const std::string& map_file, const std::string& localization_map_file, const VoxelWeighting& weighting,
             int threads, const std::function<void(std::size_t done, std::size_t of)>& progress) {
  weighting.check();
  MapFileReader reader(map_file);
  const MapOrigin& origin = reader.origin();
  if (origin.resolution_m < kLeastResolution_m) {
    throw Error(map_file, "", "has voxels smaller than a millimetre, which a localization map has no room for");
  }
  const BlockPacker packer(origin, weighting);
  const EntriesAroundBlocks entries(reader, packer.margin());
  LocalizationMapWriter writer(localization_map_file, origin, weighting);
  const std::vector<TileCoordinate> blocks = entries.blocks();
  const auto at_once = static_cast<std::size_t>(threadCount(threads));
  for (std::size_t first = 0; first < blocks.size(); first += at_once) {
    std::vector<std::vector<PackedTile>> packed(std::min(at_once, blocks.size() - first));
    try {
      forEachChunkOffline(threads, packed.size(), [&](std::size_t i, int) {
        packed[i] = packer.pack(blocks[first + i], entries.around(blocks[first + i]));
      });
    } catch (const std::length_error& error) {
      throw Error(map_file, "", error.what());
    }
    for (const std::vector<PackedTile>& of_block : packed) {
      for (const PackedTile& tile : of_block) {
        if (!isWithinReach(tile.at, origin.resolution_m)) {
          throw Error(map_file, "", "has voxels farther from its origin than a localization map reaches");
        }
        writer.add(tile);
      }
    }
    if (progress) progress(first + packed.size(), blocks.size());
  }
  writer.finish();
}

}  // namespace saw_ndt
