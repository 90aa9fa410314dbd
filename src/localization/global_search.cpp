#include "saw_ndt/localization/global_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

#include "common/executor.h"
#include "localization/place_index.h"
#include "localization/place_table.h"
#include "localization/scan_outline.h"
#include "map/localization_map_file.h"
#include "registration/source_check.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt {

using namespace internal;

void GlobalSearchOptions::check() const {
  checkOption(cells >= 8 && cells <= kMostOffsets && cells % 8 == 0, "cells", static_cast<double>(cells),
              "a multiple of 8 from 8 to 504");
  checkOption(heading_step_deg >= 0.1 && heading_step_deg <= 90.0, "heading_step_deg", heading_step_deg,
              "between 0.1 and 90");
  checkOption(candidates >= 1, "candidates", static_cast<double>(candidates), "1 or more");
  checkOption(least_share > 0.0 && least_share <= 1.0, "least_share", least_share, "between 0, exclusive, and 1");
}

namespace {

// With fewer cells that match, any place will do.
constexpr int kLeastCount = 12;

// Of a tile, places that match so much less than its best are not looked at.
constexpr double kWorseShare = 0.15;

// Candidates differ at least so much.
constexpr double kOtherPlace_m = 4.0;
constexpr double kOtherHeading_deg = 15.0;

// The best of each bucket of a tile is kept.
constexpr int kBucketColumns = 8;
constexpr int kBucketsPerRow = kPlaceTileSize / kBucketColumns;
constexpr int kBucketHeadings = 12;

// A place, and how many cells match there.
struct Place {
  int count = 0;
  Column column;
  int heading = 0;
  Column tile;
  float ground_m = 0.0F;
};

// The cells of a scan under each heading.
struct TurnedOutlines {
  std::vector<double> headings_rad;
  std::vector<OutlineOffset> offsets;  // heading after heading
  std::size_t per_heading = 0;
};

TurnedOutlines turned(const std::vector<OutlineCell>& cells, const std::vector<double>& headings_rad) {
  TurnedOutlines outlines;
  outlines.headings_rad = headings_rad;
  outlines.per_heading = (cells.size() + 7) / 8 * 8;
  for (const double heading_rad : headings_rad) {
    const double c = std::cos(heading_rad), s = std::sin(heading_rad);
    const std::size_t first = outlines.offsets.size();
    for (const OutlineCell& cell : cells) {
      // The vehicle stands in the middle of a column.
      const int x = static_cast<int>(std::floor((c * cell.x_m - s * cell.y_m) / kColumn_m + 0.5));
      const int y = static_cast<int>(std::floor((s * cell.x_m + c * cell.y_m) / kColumn_m + 0.5));
      if (x < -kPlaceTileSize || x >= kPlaceTileSize || y < -kPlaceTileSize || y >= kPlaceTileSize) continue;
      OutlineOffset& offset = outlines.offsets.emplace_back();
      offset.rows = static_cast<std::int16_t>(y);
      offset.shift = static_cast<std::uint8_t>(x & (kPlaceTileSize - 1));
      offset.tile_x = x < 0 ? 0 : 1;
      offset.first_word = cell.layer * kPlaceTileRows;
    }
    OutlineOffset none;
    none.first_word = kEmptyLayer * kPlaceTileRows;
    outlines.offsets.resize(first + outlines.per_heading, none);
  }
  return outlines;
}

}  // namespace

struct GlobalSearch::Parts {
  GlobalSearchOptions options;
  std::optional<PlaceIndex> index;     // of a target
  std::optional<LocalizationMap> map;  // otherwise, whose tables are read as they are needed

  std::vector<double> headingsOf(const std::optional<SearchRegion>& region) const {
    const int count = static_cast<int>(std::ceil(360.0 / options.heading_step_deg));
    std::vector<double> headings_rad;
    for (int i = 0; i < count; ++i) {
      const double heading_rad = 2.0 * kPi * i / count;
      const double away_rad = region ? std::abs(wrappedAngle(heading_rad - heading(region->T_map_base))) : 0.0;
      if (!region || degreesFromRadians(away_rad) <= region->heading_deg + options.heading_step_deg) {
        headings_rad.push_back(heading_rad);
      }
    }
    return headings_rad;
  }
};

namespace {

// Whether the middle of a column is in a region.
bool isWithin(const Column& column, const SearchRegion& region) {
  const Eigen::Vector2d position_m((column.x + 0.5) * kColumn_m, (column.y + 0.5) * kColumn_m);
  return (position_m - region.T_map_base.translation().head<2>()).norm() <= region.radius_m + kColumn_m;
}

bool mayBeWithin(const PlaceIndex::Tile& tile, const SearchRegion& region) {
  constexpr double kTile_m = kPlaceTileSize * kColumn_m;
  const Eigen::Vector2d middle_m((tile.at.x + 0.5) * kTile_m, (tile.at.y + 0.5) * kTile_m);
  return (middle_m - region.T_map_base.translation().head<2>()).norm() <= region.radius_m + kTile_m;
}

// Looks for a scan at all places of a tile.
class TileSearch {
 public:
  TileSearch(const PlaceIndex& index, const PlaceIndex::Tile& tile, const std::optional<SearchRegion>& region,
             int least_count, int worse)
      : tile_(tile), tables_(index.tablesAround(tile_)), region_(region), least_count_(least_count), worse_(worse) {}

  std::vector<Place> search(const TurnedOutlines& outlines) {
    const int headings = static_cast<int>(outlines.headings_rad.size());
    for (int heading = 0; heading < headings; ++heading) {
      const OutlineOffset* const offsets =
          outlines.offsets.data() + static_cast<std::size_t>(heading) * outlines.per_heading;
      const int sector =
          static_cast<int>((wrappedAngle(outlines.headings_rad[static_cast<std::size_t>(heading)]) + kPi) /
                           (2.0 * kPi) * kBucketHeadings) %
          kBucketHeadings;
      for (int row = 0; row < kPlaceTileSize; row += kRowsAtOnce) {
        const std::uint64_t* const allowed = tile_.allowed.data() + row;
        if (std::all_of(allowed, allowed + kRowsAtOnce, [](std::uint64_t bits) { return bits == 0; })) continue;
        if (countMatches(tables_, offsets, outlines.per_heading, row, least_count_, allowed, counts_)) {
          take(row, heading, sector);
        }
      }
    }
    std::vector<Place> places;
    for (const Place& place : best_) {
      if (place.count >= least_count_) places.push_back(place);
    }
    return places;
  }

 private:
  void take(int first_row, int heading, int sector) {
    for (int row = 0; row < kRowsAtOnce; ++row) {
      for (std::uint64_t bits = counts_.enough[row]; bits != 0; bits &= bits - 1) {
        const int x = __builtin_ctzll(bits);
        const int y = first_row + row;
        const int count = counts_.count(row, x);
        const int bucket = (sector * kBucketsPerRow + y / kBucketColumns) * kBucketsPerRow + x / kBucketColumns;
        Place& best = best_[static_cast<std::size_t>(bucket)];
        if (count <= best.count) continue;
        const Column column{tile_.at.x * kPlaceTileSize + x, tile_.at.y * kPlaceTileSize + y};
        if (region_ && !isWithin(column, *region_)) continue;
        best = {count, column, heading, tile_.at, tile_.ground_m[static_cast<std::size_t>(y * kPlaceTileSize + x)]};
        least_count_ = std::max(least_count_, count - worse_);
      }
    }
  }

  const PlaceIndex::Tile& tile_;
  PlaceTables tables_;
  const std::optional<SearchRegion>& region_;
  int least_count_;
  int worse_;
  PlaceCounts counts_{};
  std::array<Place, kBucketHeadings * kBucketsPerRow * kBucketsPerRow> best_{};
};

bool isBetter(const Place& a, const Place& b) {
  return std::tuple(-a.count, a.tile.y, a.tile.x, a.heading, a.column.y, a.column.x) <
         std::tuple(-b.count, b.tile.y, b.tile.x, b.heading, b.column.y, b.column.x);
}

// Looks for a scan in those tiles of an index that are asked for.
class IndexSearch {
 public:
  IndexSearch(const ScanOutline& outline, const TurnedOutlines& outlines, const GlobalSearchOptions& options,
              const std::optional<SearchRegion>& region, int threads)
      : outlines_(outlines),
        region_(region),
        least_count_(leastCount(outline, options)),
        worse_(static_cast<int>(kWorseShare * static_cast<double>(outline.cells.size()))),
        threads_(threads) {}

  static int leastCount(const ScanOutline& outline, const GlobalSearchOptions& options) {
    return std::max(kLeastCount, static_cast<int>(options.least_share * static_cast<double>(outline.cells.size())));
  }

  /// @param first_row, last_row  tiles of other rows are there as neighbours
  void search(const PlaceIndex& index, int first_row, int last_row) {
    std::vector<const PlaceIndex::Tile*> searched;
    for (std::size_t i = 0; i < index.standingTileCount(); ++i) {
      const PlaceIndex::Tile& tile = index.tiles()[i];
      if (tile.at.y < first_row || tile.at.y > last_row || (region_ && !mayBeWithin(tile, *region_))) continue;
      searched.push_back(&tile);
    }
    std::vector<std::vector<Place>> found(searched.size());
    forEachChunk(threads_, searched.size(), [&](std::size_t i, int) {
      found[i] = TileSearch(index, *searched[i], region_, least_count_, worse_).search(outlines_);
    });
    for (const std::vector<Place>& of_tile : found) places_.insert(places_.end(), of_tile.begin(), of_tile.end());
  }

  std::vector<Place> takePlaces() {
    std::sort(places_.begin(), places_.end(), isBetter);
    return std::move(places_);
  }

 private:
  const TurnedOutlines& outlines_;
  const std::optional<SearchRegion>& region_;
  int least_count_;
  int worse_;
  int threads_;
  std::vector<Place> places_;
};

// Searches a map row after row of its tiles, a few of them at a time.
void searchMap(const LocalizationMapFile& file, const std::optional<SearchRegion>& region, int threads,
               IndexSearch& search) {
  constexpr std::size_t kTilesAtOnce = 512;
  static_assert(kPlaceTileSize * kColumn_m == kLocalizationTile_m);
  std::vector<LocalizationTilePlace> places;
  if (region) {
    // With the neighbours of those that mayBeWithin().
    places = file.tilesAround(region->T_map_base.translation().head<2>(), region->radius_m + 3.0 * kLocalizationTile_m);
  } else {
    places = file.allTiles();
  }
  places.erase(std::remove_if(places.begin(), places.end(),
                              [](const LocalizationTilePlace& place) { return place.table_bytes == 0; }),
               places.end());
  const auto rowFrom = [&](int y) {
    return static_cast<std::size_t>(
        std::lower_bound(places.begin(), places.end(), y,
                         [](const LocalizationTilePlace& place, int row) { return place.at.y < row; }) -
        places.begin());
  };
  for (std::size_t first = 0; first < places.size();) {
    std::size_t next = first;
    do next = rowFrom(places[next].at.y + 1);
    while (next < places.size() && next - first < kTilesAtOnce);
    const int first_row = places[first].at.y, last_row = places[next - 1].at.y;
    const std::size_t begin = rowFrom(first_row - 1), end = rowFrom(last_row + 2);
    std::vector<PlaceIndex::Tile> tiles(end - begin);
    forEachChunk(threads, tiles.size(), [&](std::size_t i, int) {
      const LocalizationTilePlace& place = places[begin + i];
      tiles[i].at = {place.at.x, place.at.y};
      if (!decodePlaceTile(file.searchTable(place), tiles[i])) {
        failAt(file.path(), place.offset + place.cell_bytes, "damaged: a search table cannot be decompressed");
      }
    });
    search.search(PlaceIndex(std::move(tiles)), first_row, last_row);
    first = next;
  }
}

}  // namespace

GlobalSearch::GlobalSearch(const NdtTarget& target, const GlobalSearchOptions& options) {
  options.check();
  parts_ = std::make_shared<const Parts>(Parts{options, PlaceIndex(target), std::nullopt});
}

GlobalSearch::GlobalSearch(const LocalizationMap& map, const GlobalSearchOptions& options) {
  options.check();
  parts_ = std::make_shared<const Parts>(Parts{options, std::nullopt, map});
}

std::vector<PoseCandidate> GlobalSearch::candidates(const SourcePoints& source,
                                                    const std::optional<SearchRegion>& region, int threads) const {
  requireRegistrable(source);
  const ScanOutline outline = outlineOf(source, parts_->options.cells);
  const auto cell_count = static_cast<double>(outline.cells.size());
  if (outline.cells.size() < static_cast<std::size_t>(IndexSearch::leastCount(outline, parts_->options))) return {};
  const TurnedOutlines outlines = turned(outline.cells, parts_->headingsOf(region));
  IndexSearch search(outline, outlines, parts_->options, region, threads);
  if (parts_->map) {
    searchMap(parts_->map->file(), region, threads, search);
  } else {
    search.search(*parts_->index, std::numeric_limits<int>::min(), std::numeric_limits<int>::max());
  }
  const std::vector<Place> places = search.takePlaces();

  std::vector<PoseCandidate> candidates;
  for (const Place& place : places) {
    if (candidates.size() == parts_->options.candidates) break;
    PoseCandidate candidate;
    candidate.matched_share = place.count / cell_count;
    candidate.T_map_base.translation() << (place.column.x + 0.5) * kColumn_m, (place.column.y + 0.5) * kColumn_m,
        static_cast<double>(place.ground_m) + outline.base_height_m;
    candidate.T_map_base.linear() =
        rotationFromVector({0.0, 0.0, outlines.headings_rad[static_cast<std::size_t>(place.heading)]});
    const bool is_another = std::none_of(candidates.begin(), candidates.end(), [&](const PoseCandidate& better) {
      const Eigen::Isometry3d away = better.T_map_base.inverse() * candidate.T_map_base;
      return away.translation().head<2>().norm() < kOtherPlace_m &&
             degreesFromRadians(rotationAngle(away.linear())) < kOtherHeading_deg;
    });
    if (is_another) candidates.push_back(candidate);
  }
  return candidates;
}

std::size_t GlobalSearch::memoryUsage() const {
  return parts_->index ? parts_->index->tiles().capacity() * sizeof(PlaceIndex::Tile) : 0;
}

}  // namespace saw_ndt
