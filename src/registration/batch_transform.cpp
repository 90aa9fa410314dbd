#include "registration/batch_transform.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "registration/batch_transform.cpp"
#include "common/vector_dispatch.h"

HWY_BEFORE_NAMESPACE();
namespace saw_ndt::internal {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Float = hn::CappedTag<float, kMostLanes>;
using Int = hn::RebindToSigned<Float>;
using Vector = hn::Vec<Float>;

// Voxels beyond are out of reach of any map; the number still fits an integer and a float.
constexpr float kFarthestVoxel = 1.0e9F;

void findRuns(std::size_t count, BatchPoints& points) {
  const Int di;
  const std::size_t lanes = hn::Lanes(di);
  std::size_t runs = 1;
  points.run_starts[0] = 0;
  for (std::size_t i = 1; i < count; i += lanes) {
    auto changed = hn::Ne(hn::LoadU(di, points.voxel[0] + i), hn::LoadU(di, points.voxel[0] + i - 1));
    for (std::size_t axis = 1; axis < 3; ++axis) {
      const std::int32_t* const voxel = points.voxel[axis] + i;
      changed = hn::Or(changed, hn::Ne(hn::LoadU(di, voxel), hn::LoadU(di, voxel - 1)));
    }
    runs += hn::CompressStore(hn::Iota(di, static_cast<std::int32_t>(i)), changed, di, points.run_starts + runs);
  }
  const auto end = static_cast<std::int32_t>(count);
  while (points.run_starts[runs - 1] >= end) --runs;
  points.run_starts[runs] = end;
  points.run_count = runs;
}

void transform(const float* x, const float* y, const float* z, std::size_t count, const BatchPose& pose,
               BatchPoints& points) {
  const Float d;
  const Int di;
  const std::size_t lanes = hn::Lanes(d);
  const Vector far = hn::Set(d, kFarthestVoxel);
  // One vector more than holds the points: what a vector that begins at the last point reads must be set.
  for (std::size_t i = 0; i < count + lanes; i += lanes) {
    const Vector px = hn::LoadU(d, x + i), py = hn::LoadU(d, y + i), pz = hn::LoadU(d, z + i);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float* const row = pose.rotation + 3 * axis;
      const Vector rotated =
          hn::MulAdd(hn::Set(d, row[0]), px, hn::MulAdd(hn::Set(d, row[1]), py, hn::Mul(hn::Set(d, row[2]), pz)));
      const Vector moved = hn::Add(rotated, hn::Set(d, pose.translation[axis]));
      const Vector voxel = hn::Clamp(hn::Floor(hn::Mul(moved, hn::Set(d, pose.inverse_resolution))), hn::Neg(far), far);
      const Vector centre = hn::Mul(hn::Add(voxel, hn::Set(d, 0.5F)), hn::Set(d, pose.resolution_m));
      hn::Store(rotated, d, points.rotated[axis] + i);
      hn::Store(hn::Sub(moved, centre), d, points.from_centre[axis] + i);
      hn::Store(hn::ConvertTo(di, voxel), di, points.voxel[axis] + i);
    }
  }
  findRuns(count, points);
}

void columnsOf(const float* HWY_RESTRICT x, const float* HWY_RESTRICT y, std::size_t count, float inverse_column_m,
               std::uint16_t* HWY_RESTRICT columns) {
  constexpr int kMask = (1 << kColumnBits) - 1;
  const Float d;
  const Int di;
  const std::size_t lanes = hn::Lanes(d);
  const auto place = [&](const float* from) HWY_ATTR {
    const Vector far = hn::Set(d, kFarthestVoxel);
    const Vector scaled = hn::Mul(hn::LoadU(d, from), hn::Set(d, inverse_column_m));
    return hn::And(hn::ConvertTo(di, hn::Floor(hn::Clamp(scaled, hn::Neg(far), far))), hn::Set(di, kMask));
  };
  const hn::Rebind<std::uint16_t, Float> du16;
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto column = hn::Or(place(x + i), hn::ShiftLeft<kColumnBits>(place(y + i)));
    hn::StoreU(hn::DemoteTo(du16, column), du16, columns + i);
  }
  if (i == count) return;
  float rest[2][kMostLanes] = {};
  std::uint16_t rest_columns[kMostLanes];
  for (std::size_t k = 0; i + k < count; ++k) {
    rest[0][k] = x[i + k];
    rest[1][k] = y[i + k];
  }
  columnsOf(rest[0], rest[1], lanes, inverse_column_m, rest_columns);
  for (std::size_t k = 0; i + k < count; ++k) columns[i + k] = rest_columns[k];
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace saw_ndt::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace saw_ndt::internal {

HWY_EXPORT(columnsOf);
HWY_EXPORT(transform);

void transformBatch(const float* x, const float* y, const float* z, std::size_t count, const BatchPose& pose,
                    BatchPoints& points) {
  SAW_NDT_DISPATCH(transform)(x, y, z, count, pose, points);
}

void findColumns(const float* x, const float* y, std::size_t count, float inverse_column_m, std::uint16_t* columns) {
  SAW_NDT_DISPATCH(columnsOf)(x, y, count, inverse_column_m, columns);
}

}  // namespace saw_ndt::internal
#endif
