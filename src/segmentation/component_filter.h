#pragma once

#include <cstdint>
#include <vector>

#include "saw_ndt/common/labels.h"
#include "saw_ndt/common/sensor_model.h"
#include "saw_ndt/segmentation/segmentation_options.h"
#include "segmentation/range_image.h"

namespace saw_ndt::internal {

/// Two runs of pixels (see ComponentFilter), one above the other, that are connected.
struct RunPair {
  std::int32_t above;
  std::int32_t below;
};

/// Groups the pixels that are no ground into connected components and tells the large from the small (section III.A of
/// the paper). Components are 4-connected and go on over the azimuth seam. Memory is kept from one image to the next.
class ComponentFilter {
 public:
  /// Labels every pixel, row-major: Ground where `ground` is 1, NonGround in components that are kept, and Noise in the
  /// others and where there is no return. The options have been checked, the image was projected with the sensor model.
  /// The result does not depend on the number of threads.
  void label(const RangeImage& image, const SensorModel& sensor, const std::vector<std::uint8_t>& ground,
             const ComponentOptions& options, std::vector<StructuralLabel>& labels, int threads = 1);

 private:
  static constexpr int kNoRow = -1;

  /// Pixels of one row that are connected one to the next, as a node of a forest. A parent has a smaller number than
  /// its children, a root is its own parent. The runs of a row are numbered from its first pixel on.
  struct Run {
    std::int32_t parent;
    std::int32_t points;
    std::uint16_t top_row;     ///< of the run
    std::uint16_t bottom_row;  ///< of a root: of the whole component, as `points` is
    std::uint16_t begin;       ///< columns
    std::uint16_t end;
  };

  /// What one thread needs to link the pixels of a row.
  struct RowBuffers {
    int row = kNoRow;            ///< which row `current` holds
    std::vector<float> current;  ///< ranges without those of ground, and one before the first
    std::vector<float> above;
    std::vector<std::uint8_t> links;        ///< of each pixel; longer than the row, 0 from there on
    std::vector<std::uint64_t> active;      ///< a bit a pixel: whether it is a return that is no ground
    std::vector<std::uint32_t> point_sums;  ///< returns in all pixels before one
    std::vector<std::uint16_t> begins;      ///< of runs, by their order in the row
    std::vector<std::uint16_t> ends;
    std::vector<RunPair> pairs;
    std::vector<std::uint64_t> kept;  ///< a bit a pixel, and a word more
  };

  void prepare(const RangeImage& image, int threads);
  void readRow(int row, const RangeImage& image, const std::vector<std::uint8_t>& ground, RowBuffers& buffers) const;
  void findRuns(int row, const RangeImage& image, const SensorModel& sensor, const std::vector<std::uint8_t>& ground,
                const ComponentOptions& options, RowBuffers& buffers);
  void joinRowAbove(int row, RowBuffers& buffers);
  void writeLabels(int row, const std::vector<std::uint8_t>& ground, const ComponentOptions& options,
                   RowBuffers& buffers, std::vector<StructuralLabel>& labels) const;
  std::int32_t rootOf(std::int32_t run);
  void unite(std::int32_t first, std::int32_t second);

  std::int32_t columns_ = 0;
  std::size_t words_ = 0;  ///< of 64 pixels, a row
  std::vector<Run> runs_;
  std::vector<std::int32_t> run_count_;      ///< of each row
  std::vector<std::uint64_t> starts_;        ///< a bit a pixel: whether a run begins there
  std::vector<std::uint64_t> joined_;        ///< a bit a pixel: whether the run of the pixel before it goes on there
  std::vector<std::uint64_t> linked_above_;  ///< a bit a pixel: whether it is connected to the one above
  std::vector<std::int32_t> runs_before_;    ///< the number of the first run that begins in each word, or after it
  std::vector<RowBuffers> buffers_;          ///< one a thread
};

}  // namespace saw_ndt::internal
