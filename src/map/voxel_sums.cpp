#include "saw_ndt/map/voxel_sums.h"

namespace saw_ndt {
namespace {

// Sums of a damaged or hostile file may overflow; as unsigned they wrap around, which is defined.
void accumulate(std::int64_t& total, std::uint64_t term) {
  total = static_cast<std::int64_t>(static_cast<std::uint64_t>(total) + term);
}

}  // namespace

VoxelSums& VoxelSums::operator+=(const VoxelSums& other) {
  count += other.count;
  for (std::size_t i = 0; i < sum.size(); ++i) accumulate(sum[i], static_cast<std::uint64_t>(other.sum[i]));
  for (std::size_t i = 0; i < product.size(); ++i) {
    accumulate(product[i], static_cast<std::uint64_t>(other.product[i]));
  }
  return *this;
}

VoxelSums VoxelSums::shifted(const std::array<std::int64_t, 3>& shift) const {
  VoxelSums result = *this;
  std::size_t k = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto shift_i = static_cast<std::uint64_t>(shift[i]);
    const auto sum_i = static_cast<std::uint64_t>(sum[i]);
    accumulate(result.sum[i], count * shift_i);
    for (std::size_t j = i; j < 3; ++j, ++k) {
      const auto shift_j = static_cast<std::uint64_t>(shift[j]);
      const auto sum_j = static_cast<std::uint64_t>(sum[j]);
      accumulate(result.product[k], sum_i * shift_j + sum_j * shift_i + count * shift_i * shift_j);
    }
  }
  return result;
}

}  // namespace saw_ndt
