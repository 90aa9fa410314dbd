#include "segmentation/component_filter.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <utility>

#include "common/executor.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"
#include "segmentation/component_loops.h"

namespace saw_ndt::internal {
namespace {

// LeGO-LOAM connects ranges d1 >= d2, an angle a apart, where atan2(d2 sin a, d1 - d2 cos a) > t. As d1 > d2 cos a,
// that is d2 (sin a / tan t + cos a) > d1; this is the factor of d2.
float connectionRatio(double apart_deg, double threshold_deg) {
  const double apart = radiansFromDegrees(apart_deg);
  return static_cast<float>(std::sin(apart) / std::tan(radiansFromDegrees(threshold_deg)) + std::cos(apart));
}

}  // namespace

void ComponentFilter::label(const RangeImage& image, const SensorModel& sensor, const std::vector<std::uint8_t>& ground,
                            const ComponentOptions& options, std::vector<StructuralLabel>& labels, int threads) {
  prepare(image, threads);
  labels.resize(image.range().size());
  const int rows = image.rows();
  // Bands of rows are joined within first and with one another at last. Small ones wait less for each other.
  constexpr int kBandsPerThread = 4;
  const int bands = threads == 1 ? 1 : std::min(rows, kBandsPerThread * threads);
  const auto first_row = [&](int band) { return static_cast<int>(static_cast<std::ptrdiff_t>(rows) * band / bands); };
  internal::forEachChunk(threads, static_cast<std::size_t>(bands), [&](std::size_t chunk, int worker) {
    const int band = static_cast<int>(chunk);
    RowBuffers& buffers = buffers_[worker];
    for (int row = first_row(band); row < first_row(band + 1); ++row) {
      findRuns(row, image, sensor, ground, options, buffers);
      if (row > first_row(band)) joinRowAbove(row, buffers);
    }
  });
  for (int band = 1; band < bands; ++band) joinRowAbove(first_row(band), buffers_[0]);
  internal::forEachChunk(threads, static_cast<std::size_t>(bands), [&](std::size_t chunk, int worker) {
    const int band = static_cast<int>(chunk);
    for (int row = first_row(band); row < first_row(band + 1); ++row) {
      writeLabels(row, ground, options, buffers_[worker], labels);
    }
  });
}

void ComponentFilter::prepare(const RangeImage& image, int threads) {
  columns_ = image.columns();
  const auto columns = static_cast<std::size_t>(columns_);
  const auto rows = static_cast<std::size_t>(image.rows());
  words_ = (columns + 63) / 64;
  runs_.resize(rows * columns);
  run_count_.resize(rows);
  starts_.resize(rows * words_);
  joined_.resize(rows * words_);
  linked_above_.resize(rows * words_);
  runs_before_.resize(rows * words_);
  if (buffers_.size() < static_cast<std::size_t>(threads)) buffers_.resize(static_cast<std::size_t>(threads));
  for (RowBuffers& buffers : buffers_) {
    buffers.row = kNoRow;
    buffers.current.resize(columns + 1);
    buffers.above.resize(columns + 1);
    buffers.links.resize(64 * words_);
    buffers.active.resize(words_);
    buffers.point_sums.resize(columns + 1);
    buffers.begins.resize(columns);
    buffers.ends.resize(columns);
    buffers.pairs.resize(columns);
    buffers.kept.resize(words_ + 1);
  }
}

void ComponentFilter::readRow(int row, const RangeImage& image, const std::vector<std::uint8_t>& ground,
                              RowBuffers& buffers) const {
  const auto columns = static_cast<std::size_t>(columns_);
  const std::size_t begin = static_cast<std::size_t>(row) * columns;
  takeOutGround(columns, image.range().data() + begin, ground.data() + begin, buffers.current.data() + 1);
  buffers.current[0] = buffers.current[columns];  // the pixel before the first is the last: over the azimuth seam
  buffers.row = row;
}

void ComponentFilter::findRuns(int row, const RangeImage& image, const SensorModel& sensor,
                               const std::vector<std::uint8_t>& ground, const ComponentOptions& options,
                               RowBuffers& buffers) {
  const auto columns = static_cast<std::size_t>(columns_);
  if (row > 0 && buffers.row != row - 1) readRow(row - 1, image, ground, buffers);
  std::swap(buffers.current, buffers.above);
  if (row == 0) std::fill(buffers.above.begin(), buffers.above.end(), 0.0F);  // nothing is above the top row
  readRow(row, image, ground, buffers);
  const double apart_deg = row > 0 ? sensor.elevations_deg[row - 1] - sensor.elevations_deg[row] : 0.0;
  const ConnectionRatios ratios = {connectionRatio(360.0 / columns_, options.connection_angle_deg),
                                   connectionRatio(apart_deg, options.connection_angle_deg)};
  linkPixels(columns, ratios, buffers.current.data(), buffers.above.data() + 1, buffers.links.data());
  std::fill(buffers.links.begin() + columns_, buffers.links.end(), std::uint8_t{0});
  const std::size_t first_word = static_cast<std::size_t>(row) * words_;
  std::uint64_t* const active = buffers.active.data();
  std::uint64_t* const starts = starts_.data() + first_word;
  std::uint64_t* const joined = joined_.data() + first_word;
  bitsOfLinks(words_, buffers.links.data(), active, joined, linked_above_.data() + first_word);
  const bool goes_on_over_seam = (joined[0] & 1) != 0;
  joined[0] &= ~std::uint64_t{1};

  const std::uint16_t* const returns = image.returns().data() + static_cast<std::ptrdiff_t>(row) * columns_;
  std::uint32_t* const point_sums = buffers.point_sums.data();
  std::uint32_t point_sum = 0;
  for (std::size_t column = 0; column < columns; ++column) {
    point_sums[column] = point_sum;
    point_sum += returns[column];
  }
  point_sums[columns] = point_sum;

  const std::int32_t first_run = row * columns_;
  std::int32_t begun = first_run;
  for (std::size_t word = 0; word < words_; ++word) {
    starts[word] = active[word] & ~joined[word];
    runs_before_[first_word + word] = begun;
    begun += static_cast<std::int32_t>(std::bitset<64>(starts[word]).count());
  }
  columnsOfBits(words_, starts, 0, buffers.begins.data());
  for (std::size_t word = 0; word < words_; ++word) {
    active[word] &= ~(joined[word] >> 1 | (word + 1 < words_ ? joined[word + 1] << 63 : 0));  // where runs end
  }
  columnsOfBits(words_, active, 1, buffers.ends.data());
  run_count_[row] = begun - first_run;
  Run* const runs = runs_.data() + first_run;
  for (std::int32_t i = 0; i < run_count_[row]; ++i) {
    const std::uint16_t begin = buffers.begins[i];
    const std::uint16_t end = buffers.ends[i];
    const auto own_row = static_cast<std::uint16_t>(row);
    runs[i] = {
        first_run + i, static_cast<std::int32_t>(point_sums[end] - point_sums[begin]), own_row, own_row, begin, end};
  }
  if (goes_on_over_seam) unite(first_run, begun - 1);
}

void ComponentFilter::joinRowAbove(int row, RowBuffers& buffers) {
  const std::size_t word = static_cast<std::size_t>(row) * words_;
  const auto bitsFrom = [this](std::size_t first_word) {
    return RowBits{starts_.data() + first_word, joined_.data() + first_word, runs_before_.data() + first_word};
  };
  const std::size_t pairs =
      pairsOfRuns(words_, bitsFrom(word), bitsFrom(word - words_), linked_above_.data() + word, buffers.pairs.data());
  for (std::size_t i = 0; i < pairs; ++i) unite(buffers.pairs[i].above, buffers.pairs[i].below);
}

void ComponentFilter::writeLabels(int row, const std::vector<std::uint8_t>& ground, const ComponentOptions& options,
                                  RowBuffers& buffers, std::vector<StructuralLabel>& labels) const {
  // A bit where what is kept begins and one where it ends.
  std::uint64_t* const kept = buffers.kept.data();
  std::fill_n(kept, words_ + 1, 0);
  for (std::int32_t index = row * columns_; index < row * columns_ + run_count_[row]; ++index) {
    const Run& run = runs_[index];
    const Run* root = &run;
    for (std::int32_t i = index; root->parent != i; root = &runs_[i]) i = root->parent;
    // 4-connected: the rows of a component have no gap, and its root is in the topmost.
    const int rings = root->bottom_row - root->top_row + 1;
    const bool is_tall = (root->points >= options.min_points_tall) & (rings >= options.min_rings_tall);
    const auto is_kept = static_cast<std::uint64_t>(is_tall | (root->points >= options.min_points));
    kept[run.begin / 64] ^= is_kept << run.begin % 64;
    kept[run.end / 64] ^= is_kept << run.end % 64;
  }
  std::uint64_t goes_on = 0;  // all bits where what is kept goes on from the word before
  for (std::size_t word = 0; word < words_; ++word) {
    std::uint64_t bits = kept[word];
    for (int shift = 1; shift < 64; shift *= 2) bits ^= bits << shift;
    kept[word] = bits ^ goes_on;
    goes_on = 0 - (kept[word] >> 63);
  }
  const std::ptrdiff_t begin = static_cast<std::ptrdiff_t>(row) * columns_;
  labelPixels(static_cast<std::size_t>(columns_), ground.data() + begin, kept, labels.data() + begin);
}

std::int32_t ComponentFilter::rootOf(std::int32_t run) {
  while (runs_[run].parent != run) {
    runs_[run].parent = runs_[runs_[run].parent].parent;
    run = runs_[run].parent;
  }
  return run;
}

void ComponentFilter::unite(std::int32_t first, std::int32_t second) {
  first = rootOf(first);
  second = rootOf(second);
  if (first == second) return;
  Run& root = runs_[std::min(first, second)];
  Run& child = runs_[std::max(first, second)];
  child.parent = std::min(first, second);
  root.points += child.points;
  root.bottom_row = std::max(root.bottom_row, child.bottom_row);
}

}  // namespace saw_ndt::internal
