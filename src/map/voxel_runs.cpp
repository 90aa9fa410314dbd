#include "map/voxel_runs.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "map/voxel_runs.cpp"
#include "common/vector_dispatch.h"

HWY_BEFORE_NAMESPACE();
namespace saw_ndt::internal {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr double kCoordinateLimit = 2147483000.0;  // as in quantize()
constexpr double kSteps = 65536.0;

#if HWY_TARGET == HWY_EMU128 || HWY_TARGET == HWY_SCALAR

// Highway's stand-in for vectors is slower than plain code.
void quantizePoints(const PointPlacement& placement, PointBlock& block) {
  for (std::size_t i = 0; i < block.size; ++i) {
    const float* point = block.xyz + i * block.stride;
    const double p[3] = {point[0], point[1], point[2]};
    bool valid = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double* row = placement.T_map_points[axis];
      const double moved =
          placement.in_map_frame ? p[axis] : ((row[0] * p[0] + row[1] * p[1]) + row[2] * p[2]) + row[3];
      double scaled = moved * placement.inverse_resolution;
      if (!(scaled < kCoordinateLimit && scaled > -kCoordinateLimit)) {
        valid = false;
        scaled = 0.0;
      }
      const auto towards_zero = static_cast<std::int32_t>(scaled);
      const std::int32_t whole = towards_zero - (static_cast<double>(towards_zero) > scaled ? 1 : 0);
      block.voxel[axis][i] = whole;
      block.steps[4 * i + axis] =
          static_cast<std::int32_t>((scaled - whole) * kSteps + 0.5) - static_cast<std::int32_t>(kSteps) / 2;
    }
    block.steps[4 * i + 3] = 1;
    if (!valid) block.label[i] = kNoVoxel;
  }
}

#else

using Doubles = hn::ScalableTag<double>;
using Floats = hn::Rebind<float, Doubles>;
using Integers = hn::Rebind<std::int32_t, Doubles>;
using DoubleVector = hn::Vec<Doubles>;

struct Position {
  DoubleVector x, y, z;
};

// Points `first` onwards; beyond the last one, the last one again.
HWY_INLINE Position loadPositions(const PointBlock& block, std::size_t first) {
  const Doubles doubles;
  const Floats floats;
  const Integers integers;
  hn::Vec<Floats> x, y, z;
  if (block.stride == 4 && first + hn::Lanes(doubles) <= block.size) {
    hn::Vec<Floats> unused;
    hn::LoadInterleaved4(floats, block.xyz + 4 * first, x, y, z, unused);
  } else {
    const auto last = hn::Set(integers, static_cast<std::int32_t>(block.size - 1));
    const auto point = hn::Min(hn::Iota(integers, static_cast<std::int32_t>(first)), last);
    const auto offset = hn::Mul(point, hn::Set(integers, static_cast<std::int32_t>(block.stride)));
    x = hn::GatherIndex(floats, block.xyz, offset);
    y = hn::GatherIndex(floats, block.xyz + 1, offset);
    z = hn::GatherIndex(floats, block.xyz + 2, offset);
  }
  return {hn::PromoteTo(doubles, x), hn::PromoteTo(doubles, y), hn::PromoteTo(doubles, z)};
}

// In the order of Eigen's product with a homogeneous vector, without fused multiply-add.
HWY_INLINE DoubleVector transformed(const double* row, const Position& p) {
  const Doubles d;
  auto sum = hn::Add(hn::Mul(hn::Set(d, row[0]), p.x), hn::Mul(hn::Set(d, row[1]), p.y));
  sum = hn::Add(sum, hn::Mul(hn::Set(d, row[2]), p.z));
  return hn::Add(sum, hn::Set(d, row[3]));
}

struct Quantized {
  hn::Vec<Integers> voxel, steps;
};

HWY_INLINE Quantized quantized(DoubleVector scaled) {
  const Doubles d;
  const Integers integers;
  const auto whole = hn::Floor(scaled);
  const auto within = hn::Mul(hn::Sub(scaled, whole), hn::Set(d, kSteps));
  const auto steps = hn::DemoteTo(integers, hn::Add(within, hn::Set(d, 0.5)));
  return {hn::DemoteTo(integers, whole), hn::Sub(steps, hn::Set(integers, static_cast<std::int32_t>(kSteps) / 2))};
}

void quantizePoints(const PointPlacement& placement, PointBlock& block) {
  const Doubles d;
  const Integers integers;
  const auto limit = hn::Set(d, kCoordinateLimit);
  const auto inverse_resolution = hn::Set(d, placement.inverse_resolution);
  for (std::size_t i = 0; i < block.size; i += hn::Lanes(d)) {
    Position p = loadPositions(block, i);
    if (!placement.in_map_frame) {
      p = {transformed(placement.T_map_points[0], p), transformed(placement.T_map_points[1], p),
           transformed(placement.T_map_points[2], p)};
    }
    p = {hn::Mul(p.x, inverse_resolution), hn::Mul(p.y, inverse_resolution), hn::Mul(p.z, inverse_resolution)};
    const auto valid =
        hn::And(hn::And(hn::Lt(hn::Abs(p.x), limit), hn::Lt(hn::Abs(p.y), limit)), hn::Lt(hn::Abs(p.z), limit));
    if (HWY_UNLIKELY(!hn::AllTrue(d, valid))) {
      p = {hn::IfThenElseZero(valid, p.x), hn::IfThenElseZero(valid, p.y), hn::IfThenElseZero(valid, p.z)};
      const auto invalid = hn::DemoteTo(integers, hn::IfThenZeroElse(valid, hn::Set(d, kNoVoxel)));
      hn::StoreU(hn::Or(hn::LoadU(integers, block.label + i), invalid), integers, block.label + i);
    }
    const Quantized x = quantized(p.x), y = quantized(p.y), z = quantized(p.z);
    hn::StoreU(x.voxel, integers, block.voxel[0] + i);
    hn::StoreU(y.voxel, integers, block.voxel[1] + i);
    hn::StoreU(z.voxel, integers, block.voxel[2] + i);
    hn::StoreInterleaved4(x.steps, y.steps, z.steps, hn::Set(integers, 1), integers, block.steps + 4 * i);
  }
}

#endif  // HWY_TARGET

void compareWithThePointBefore(PointBlock& block) {
  block.same[0] = 0;
  for (std::size_t i = 1; i < block.size; ++i) {
    const std::int32_t difference = (block.voxel[0][i] ^ block.voxel[0][i - 1]) |
                                    (block.voxel[1][i] ^ block.voxel[1][i - 1]) |
                                    (block.voxel[2][i] ^ block.voxel[2][i - 1]) | (block.label[i] ^ block.label[i - 1]);
    block.same[i] = difference == 0 ? -1 : 0;
  }
}

#if HWY_TARGET == HWY_EMU128 || HWY_TARGET == HWY_SCALAR

std::size_t sumRuns(PointBlock& block) {
  std::size_t run = 0;
  for (std::size_t first = 0; first < block.size; ++run) {
    std::int32_t x_sum = 0, y_sum = 0, z_sum = 0;
    std::int64_t xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
    std::size_t i = first;
    do {
      const std::int32_t* steps = block.steps + 4 * i;
      const std::int64_t x = steps[0], y = steps[1], z = steps[2];
      x_sum += steps[0];
      y_sum += steps[1];
      z_sum += steps[2];
      xx += x * x;
      xy += x * y;
      xz += x * z;
      yy += y * y;
      yz += y * z;
      zz += z * z;
      ++i;
    } while (i < block.size && block.same[i] != 0);
    block.runs[run] = {{xx, xy, xz, yy, yz, zz}, {x_sum, y_sum, z_sum, static_cast<std::int32_t>(i - first)}};
    first = i;
  }
  return run;
}

#else

// Which of a point's x y z 1 are multiplied for xx xy xz yy yz zz, at every other place.
alignas(64) constexpr std::int32_t kFirstFactor[16] = {0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 2, 0, 0, 0, 0, 0};
alignas(64) constexpr std::int32_t kSecondFactor[16] = {0, 0, 1, 0, 2, 0, 1, 0, 2, 0, 2, 0, 0, 0, 0, 0};

// Some of a point's products, as many as the vectors of D hold, and their sums over the run so far.
template <class D>
class Products {
 public:
  explicit Products(std::size_t first)
      : first_(first),
        first_factor_(hn::SetTableIndices(D(), kFirstFactor + 2 * first)),
        second_factor_(hn::SetTableIndices(D(), kSecondFactor + 2 * first)),
        sums_(hn::Zero(Wide())) {}

  HWY_INLINE void add(const std::int32_t* HWY_RESTRICT steps, std::int32_t same, std::int64_t* HWY_RESTRICT sums) {
    const auto point = hn::LoadDup128(D(), steps);
    const auto kept = hn::And(sums_, hn::BitCast(Wide(), hn::Set(D(), same)));
    sums_ = hn::Add(
        kept, hn::MulEven(hn::TableLookupLanes(point, first_factor_), hn::TableLookupLanes(point, second_factor_)));
    hn::StoreU(sums_, Wide(), sums + first_);
  }

 private:
  using Wide = hn::RepartitionToWide<D>;
  std::size_t first_;
  decltype(hn::SetTableIndices(D(), kFirstFactor)) first_factor_, second_factor_;
  hn::Vec<Wide> sums_;
};

// Every point writes the sums so far of its run, so that there is no branch to mispredict: the last one's stay.
std::size_t sumRuns(PointBlock& block) {
  using Quadruple = hn::FixedTag<std::int32_t, 4>;
  using Most = hn::ScalableTag<std::int32_t>;
  static_assert(sizeof(VoxelRun) == 8 * sizeof(std::int64_t), "eight products, of which the last two give way to sums");
  const Quadruple d;
  const std::size_t size = block.size;
  const std::int32_t* HWY_RESTRICT all_steps = block.steps;
  const std::int32_t* HWY_RESTRICT all_same = block.same;
  Products<Most> products(0);
  Products<Quadruple> middle(2);  // those that do not fit into vectors of 128 bits
  Products<Quadruple> rest(4);    // nor into those of 256 bits
  auto sum_count = hn::Zero(d);
  std::uint32_t run = ~0U;
  for (std::size_t i = 0; i < size; ++i) {
    const std::int32_t same = all_same[i];
    run += static_cast<std::uint32_t>(1 + same);
    const std::int32_t* HWY_RESTRICT steps = all_steps + 4 * i;
    VoxelRun& sums = block.runs[run];
    products.add(steps, same, sums.product);
    if constexpr (hn::MaxLanes(Most()) < 8) middle.add(steps, same, sums.product);
    if constexpr (hn::MaxLanes(Most()) < 16) rest.add(steps, same, sums.product);
    sum_count = hn::Add(hn::And(sum_count, hn::Set(d, same)), hn::Load(d, steps));
    hn::StoreU(sum_count, d, sums.sum_count);
  }
  return run + 1;
}

#endif  // HWY_TARGET

std::size_t findRuns(const PointPlacement& placement, PointBlock& block) {
  quantizePoints(placement, block);
  compareWithThePointBefore(block);
  return sumRuns(block);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace saw_ndt::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace saw_ndt::internal {

HWY_EXPORT(findRuns);

std::size_t findVoxelRuns(const PointPlacement& placement, PointBlock& block) {
  return SAW_NDT_DISPATCH(findRuns)(placement, block);
}

}  // namespace saw_ndt::internal
#endif
