#include "map/direction_image.h"

#include <algorithm>

namespace saw_ndt::internal {
namespace {

constexpr std::size_t kPixels = static_cast<std::size_t>(DirectionImage::kColumns) * DirectionImage::kRows;

std::size_t rowStart(int row) { return static_cast<std::size_t>(row) * DirectionImage::kColumns; }

}  // namespace

DirectionImage::DirectionImage() : nearest_(kPixels, kNoRay), filled_(kPixels, kNoRay), along_rows_(kPixels, kNoRay) {
  for (std::vector<float>& least : least_) least.assign(kPixels, kNoRay);
}

void DirectionImage::make(const ScanView& scan, float least_range_m) {
  place(scan, least_range_m);
  fillBetweenBeams();
  spread();
}

void DirectionImage::place(const ScanView& scan, float least_range_m) {
  constexpr std::size_t kBlock = 256;
  // Windows of the scan before reach beyond its rows.
  const int reach = 2 << kWindows;
  const int first_cleared = std::max(first_row_ - reach, 0), last_cleared = std::min(last_row_ + reach, kRows - 1);
  const auto clear = [&](std::vector<float>& image) {
    if (first_cleared > last_cleared) return;
    std::fill(image.begin() + static_cast<std::ptrdiff_t>(rowStart(first_cleared)),
              image.begin() + static_cast<std::ptrdiff_t>(rowStart(last_cleared + 1)), kNoRay);
  };
  clear(nearest_);
  clear(filled_);
  clear(along_rows_);
  for (std::vector<float>& least : least_) clear(least);

  float x[kBlock], y[kBlock], z[kBlock], range_m[kBlock], horizontal_range_m[kBlock];
  std::int32_t pixel[kBlock];
  const DirectionGrid whole = grid(least_range_m, 1e6F);
  std::int32_t first_pixel = static_cast<std::int32_t>(kPixels), last_pixel = -1;
  for (std::size_t begin = 0; begin < scan.size; begin += kBlock) {
    const std::size_t size = std::min(kBlock, scan.size - begin);
    for (std::size_t i = 0; i < size; ++i) {
      const float* point = scan.point(begin + i);
      x[i] = point[0];
      y[i] = point[1];
      z[i] = point[2];
    }
    measureDirections(size, {x, y, z}, whole, {range_m, horizontal_range_m, pixel});
    for (std::size_t i = 0; i < size; ++i) {
      if (pixel[i] < 0) continue;
      float& nearest = nearest_[static_cast<std::size_t>(pixel[i])];
      nearest = std::min(nearest, range_m[i]);
      first_pixel = std::min(first_pixel, pixel[i]);
      last_pixel = std::max(last_pixel, pixel[i]);
    }
  }
  first_row_ = last_pixel < 0 ? kRows : first_pixel / kColumns;
  last_row_ = last_pixel < 0 ? -1 : last_pixel / kColumns;
}

void DirectionImage::fillBetweenBeams() {
  std::array<int, kColumns> row_above;
  row_above.fill(-2 * kMostGap);
  for (int row = first_row_; row <= last_row_; ++row) {
    const float* const nearest = nearest_.data() + rowStart(row);
    for (int column = 0; column < kColumns; ++column) {
      if (nearest[column] == kNoRay) continue;
      const int above = row_above[static_cast<std::size_t>(column)];
      filled_[rowStart(row) + static_cast<std::size_t>(column)] = nearest[column];
      if (row - above <= kMostGap) {
        const float nearer = std::min(nearest[column], nearest_[rowStart(above) + static_cast<std::size_t>(column)]);
        for (int between = above + 1; between < row; ++between) {
          filled_[rowStart(between) + static_cast<std::size_t>(column)] = nearer;
        }
      }
      row_above[static_cast<std::size_t>(column)] = row;
    }
  }
}

void DirectionImage::spread() {
  const std::vector<float>* from = &filled_;
  int first = first_row_, last = last_row_;
  for (int window = 0; window < kWindows; ++window) {
    // The window before, which reaches `step` pixels (the first one: none), at three places becomes twice as wide.
    const int step = window == 0 ? 1 : 1 << (window - 1);
    for (int row = first; row <= last; ++row) {
      leastAlongRow(kColumns, step, from->data() + rowStart(row), along_rows_.data() + rowStart(row));
    }
    std::vector<float>& least = least_[static_cast<std::size_t>(window)];
    const int first_wider = std::max(first - step, 0), last_wider = std::min(last + step, kRows - 1);
    const auto rowAt = [&](int row) { return along_rows_.data() + rowStart(std::clamp(row, 0, kRows - 1)); };
    for (int row = first_wider; row <= last_wider; ++row) {
      leastOfRows(kColumns, rowAt(row - step), rowAt(row), rowAt(row + step), least.data() + rowStart(row));
    }
    from = &least;
    first = first_wider;
    last = last_wider;
  }
}

}  // namespace saw_ndt::internal
