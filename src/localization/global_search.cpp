#include "saw_ndt/localization/global_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "common/executor.h"
#include "localization/place_index.h"
#include "localization/scan_outline.h"
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
  std::size_t tile = 0;
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
  PlaceIndex index;

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
  TileSearch(const PlaceIndex& index, std::size_t tile_number, const std::optional<SearchRegion>& region,
             int least_count, int worse)
      : tile_(index.tiles()[tile_number]),
        tile_number_(tile_number),
        tables_(index.tablesAround(tile_)),
        region_(region),
        least_count_(least_count),
        worse_(worse) {}

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
        best = {count, column, heading, tile_number_};
        least_count_ = std::max(least_count_, count - worse_);
      }
    }
  }

  const PlaceIndex::Tile& tile_;
  std::size_t tile_number_;
  PlaceTables tables_;
  const std::optional<SearchRegion>& region_;
  int least_count_;
  int worse_;
  PlaceCounts counts_{};
  std::array<Place, kBucketHeadings * kBucketsPerRow * kBucketsPerRow> best_{};
};

bool isBetter(const Place& a, const Place& b) {
  return std::tuple(-a.count, a.tile, a.heading, a.column.y, a.column.x) <
         std::tuple(-b.count, b.tile, b.heading, b.column.y, b.column.x);
}

}  // namespace

GlobalSearch::GlobalSearch(const NdtTarget& target, const GlobalSearchOptions& options) {
  options.check();
  parts_ = std::make_shared<const Parts>(Parts{options, PlaceIndex(target)});
}

std::vector<PoseCandidate> GlobalSearch::candidates(const SourcePoints& source,
                                                    const std::optional<SearchRegion>& region, int threads) const {
  const PlaceIndex& index = parts_->index;
  const ScanOutline outline = outlineOf(source, parts_->options.cells);
  const auto cell_count = static_cast<double>(outline.cells.size());
  const int least_count = std::max(kLeastCount, static_cast<int>(parts_->options.least_share * cell_count));
  const int worse = static_cast<int>(kWorseShare * cell_count);
  if (outline.cells.size() < static_cast<std::size_t>(least_count)) return {};
  const TurnedOutlines outlines = turned(outline.cells, parts_->headingsOf(region));

  std::vector<std::size_t> searched;
  for (std::size_t i = 0; i < index.standingTileCount(); ++i) {
    if (!region || mayBeWithin(index.tiles()[i], *region)) searched.push_back(i);
  }
  std::vector<std::vector<Place>> found(searched.size());
  forEachChunk(threads, searched.size(), [&](std::size_t i, int) {
    found[i] = TileSearch(index, searched[i], region, least_count, worse).search(outlines);
  });
  std::vector<Place> places;
  for (const std::vector<Place>& of_tile : found) places.insert(places.end(), of_tile.begin(), of_tile.end());
  std::sort(places.begin(), places.end(), isBetter);

  std::vector<PoseCandidate> candidates;
  for (const Place& place : places) {
    if (candidates.size() == parts_->options.candidates) break;
    const PlaceIndex::Tile& tile = index.tiles()[place.tile];
    const int x = place.column.x - tile.at.x * kPlaceTileSize, y = place.column.y - tile.at.y * kPlaceTileSize;
    PoseCandidate candidate;
    candidate.matched_share = place.count / cell_count;
    candidate.T_map_base.translation() << (place.column.x + 0.5) * kColumn_m, (place.column.y + 0.5) * kColumn_m,
        static_cast<double>(tile.ground_m[static_cast<std::size_t>(y * kPlaceTileSize + x)]) + outline.base_height_m;
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

std::size_t GlobalSearch::memoryUsage() const { return parts_->index.tiles().capacity() * sizeof(PlaceIndex::Tile); }

}  // namespace saw_ndt
