#include "saw_ndt/segmentation/component_filter.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"
#include "segmentation/component_loops.h"

namespace saw_ndt {
namespace {

// LeGO-LOAM connects ranges d1 >= d2, an angle a apart, where atan2(d2 sin a, d1 - d2 cos a) > t. As d1 > d2 cos a,
// that is d2 (sin a / tan t + cos a) > d1; this is the factor of d2.
float connectionRatio(double apart_deg, double threshold_deg) {
  const double apart = radiansFromDegrees(apart_deg);
  return static_cast<float>(std::sin(apart) / std::tan(radiansFromDegrees(threshold_deg)) + std::cos(apart));
}

std::size_t wordOf(std::size_t column) { return column / 64; }
std::uint64_t bitOf(std::size_t column) { return std::uint64_t{1} << column % 64; }

// Calls with the column of each bit of a word that is set, in rising order.
template <typename Callable>
void forEachBit(std::uint64_t bits, std::size_t word, const Callable& call) {
  for (; bits != 0; bits &= bits - 1) call(64 * word + static_cast<std::size_t>(__builtin_ctzll(bits)));
}

}  // namespace

void ComponentOptions::check() const {
  checkOption(connection_angle_deg > 0.0 && connection_angle_deg < 90.0, "connection_angle_deg", connection_angle_deg,
              "above 0 and below 90");
  checkOption(minimum_points >= 1, "minimum_points", minimum_points, "at least 1");
  checkOption(minimum_points_tall >= 1, "minimum_points_tall", minimum_points_tall, "at least 1");
  checkOption(minimum_rings_tall >= 1, "minimum_rings_tall", minimum_rings_tall, "at least 1");
}

void ComponentFilter::label(const RangeImage& image, const SensorModel& sensor, const std::vector<std::uint8_t>& ground,
                            const ComponentOptions& options, std::vector<StructuralLabel>& labels, int threads) {
  prepare(image, threads);
  labels.resize(image.range().size());
  const int rows = image.rows();
  const auto first_row = [&](int band) { return static_cast<int>(static_cast<std::ptrdiff_t>(rows) * band / threads); };
#pragma omp parallel num_threads(threads)
  {
    // Bands of rows, one a thread, are joined within first and with one another at last.
#pragma omp for schedule(static)
    for (int band = 0; band < threads; ++band) {
      RowBuffers& buffers = buffers_[band];
      for (int row = first_row(band); row < first_row(band + 1); ++row) {
        findRuns(row, image, sensor, ground, options, buffers);
        if (row > first_row(band)) joinRowAbove(row);
      }
    }
#pragma omp single
    {
      for (int band = 1; band < threads; ++band) {
        const int row = first_row(band);
        if (row > 0 && row < first_row(band + 1)) joinRowAbove(row);
      }
      chooseComponents(options);
    }
#pragma omp for schedule(static)
    for (int row = 0; row < rows; ++row) writeLabels(row, ground, labels);
  }
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
  std::int32_t ended = first_run;
  for (std::size_t word = 0; word < words_; ++word) {
    starts[word] = active[word] & ~joined[word];
    runs_before_[first_word + word] = begun;
    const std::uint64_t goes_on = joined[word] >> 1 | (word + 1 < words_ ? joined[word + 1] << 63 : 0);
    forEachBit(starts[word], word, [&](std::size_t column) {
      Run& run = runs_[begun];
      run.parent = begun++;
      run.bottom_row = static_cast<std::int16_t>(row);
      run.begin = static_cast<std::uint16_t>(column);
    });
    forEachBit(active[word] & ~goes_on, word, [&](std::size_t column) {
      Run& run = runs_[ended++];
      run.end = static_cast<std::uint16_t>(column + 1);
      run.points = static_cast<std::int32_t>(point_sums[run.end] - point_sums[run.begin]);
    });
  }
  run_count_[row] = begun - first_run;
  if (goes_on_over_seam) unite(first_run, begun - 1);
}

void ComponentFilter::joinRowAbove(int row) {
  const std::size_t first_word = static_cast<std::size_t>(row) * words_;
  const std::size_t first_word_above = first_word - words_;
  std::uint64_t linked_before = 0;  // the last bit of the word before
  for (std::size_t word = 0; word < words_; ++word) {
    const std::uint64_t linked = linked_above_[first_word + word];
    // Where the pixels before these are connected too, and in both rows to these, the two runs have been united.
    const std::uint64_t united =
        (linked << 1 | linked_before) & joined_[first_word + word] & joined_[first_word_above + word];
    linked_before = linked >> 63;
    forEachBit(linked & ~united, word, [&](std::size_t column) { unite(runAt(row - 1, column), runAt(row, column)); });
  }
}

std::int32_t ComponentFilter::runAt(int row, std::size_t column) const {
  const std::size_t word = static_cast<std::size_t>(row) * words_ + wordOf(column);
  const std::uint64_t starts = starts_[word] & (bitOf(column) | (bitOf(column) - 1));
  return runs_before_[word] + __builtin_popcountll(starts) - 1;
}

void ComponentFilter::chooseComponents(const ComponentOptions& options) {
  const auto rows = static_cast<std::int32_t>(run_count_.size());
  // A parent has the smaller number: from the last run on, each hands on to its parent what it holds.
  for (std::int32_t row = rows - 1; row >= 0; --row) {
    for (std::int32_t index = row * columns_ + run_count_[row] - 1; index >= row * columns_; --index) {
      const Run& run = runs_[index];
      if (run.parent == index) continue;
      Run& parent = runs_[run.parent];
      parent.points += run.points;
      parent.bottom_row = std::max(parent.bottom_row, run.bottom_row);
    }
  }
  for (std::int32_t row = 0; row < rows; ++row) {
    for (std::int32_t index = row * columns_; index < row * columns_ + run_count_[row]; ++index) {
      Run& run = runs_[index];
      if (run.parent != index) {
        run.label = runs_[run.parent].label;
        continue;
      }
      // 4-connected: the rows of a component have no gap, and its root is in the topmost.
      const int rings = run.bottom_row - row + 1;
      const bool tall = run.points >= options.minimum_points_tall && rings >= options.minimum_rings_tall;
      run.label = tall || run.points >= options.minimum_points ? StructuralLabel::NonGround : StructuralLabel::Noise;
    }
  }
}

void ComponentFilter::writeLabels(int row, const std::vector<std::uint8_t>& ground,
                                  std::vector<StructuralLabel>& labels) const {
  const std::ptrdiff_t begin = static_cast<std::ptrdiff_t>(row) * columns_;
  StructuralLabel* const label = labels.data() + begin;
  for (std::int32_t column = 0; column < columns_; ++column) {
    label[column] = ground[begin + column] != 0 ? StructuralLabel::Ground : StructuralLabel::Noise;
  }
  for (std::int32_t index = row * columns_; index < row * columns_ + run_count_[row]; ++index) {
    const Run& run = runs_[index];
    if (run.label == StructuralLabel::Noise) continue;
    for (std::uint16_t column = run.begin; column < run.end; ++column) label[column] = run.label;
  }
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
  if (first < second) {
    runs_[second].parent = first;
  } else {
    runs_[first].parent = second;
  }
}

}  // namespace saw_ndt
