#include "registration/ndt_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "registration/ndt_kernel.cpp"
#include "common/vector_dispatch.h"

HWY_BEFORE_NAMESPACE();
namespace saw_ndt {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Float = hn::CappedTag<float, kMostLanes>;
using Int = hn::RebindToSigned<Float>;
using Vector = hn::Vec<Float>;

// Voxels beyond are out of reach of any map; the number still fits an integer and a float.
constexpr float kFarthestVoxel = 1.0e9F;

// Less is raised to this: 2^-60 adds nothing, and its products are no subnormal numbers, which would slow everything
// down.
constexpr float kLeastExponent = -60.0F;

// 2^x for x <= 0, to 2e-7 of its value: x = n + f with |f| <= 1/2; a minimax polynomial of f, whose exponent n is added
// to. Adding kRound leaves n in the lowest bits of a float.
HWY_INLINE Vector exp2OfNegative(Float d, Vector x) {
  constexpr float kRound = 12582912.0F;  // 1.5 * 2^23
  const Int di;
  x = hn::Max(x, hn::Set(d, kLeastExponent));
  const Vector shifted = hn::Add(x, hn::Set(d, kRound));
  const Vector f = hn::Sub(x, hn::Sub(shifted, hn::Set(d, kRound)));
  Vector p = hn::MulAdd(f, hn::Set(d, 0.0013264727F), hn::Set(d, 0.0096715128F));
  p = hn::MulAdd(f, p, hn::Set(d, 0.0555073374F));
  p = hn::MulAdd(f, p, hn::Set(d, 0.2402224208F));
  p = hn::MulAdd(f, p, hn::Set(d, 0.6931469776F));
  p = hn::MulAdd(f, p, hn::Set(d, 1.0F));
  return hn::BitCast(d, hn::Add(hn::BitCast(di, p), hn::ShiftLeft<23>(hn::BitCast(di, shifted))));
}

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

// q and the binary logarithm of exp(-d2/2 q^T C^-1 q) for a vector of points and one voxel.
struct Offset {
  Vector x, y, z;    // C^-1 q
  Vector q_squared;  // |q|^2; computed only where asked for
  Vector exponent;
};

template <bool within_radius>
HWY_INLINE Offset offsetFrom(Float d, const RunVoxel& voxel, const PackedNdtCell& cell, Vector px, Vector py, Vector pz,
                             Vector factor, Vector unused_lanes) {
  const float* const c = cell.inverse_covariance;
  const Vector qx = hn::Sub(px, hn::Set(d, voxel.mean[0]));
  const Vector qy = hn::Sub(py, hn::Set(d, voxel.mean[1]));
  const Vector qz = hn::Sub(pz, hn::Set(d, voxel.mean[2]));
  Offset u;
  u.x = hn::MulAdd(hn::Set(d, c[0]), qx, hn::MulAdd(hn::Set(d, c[1]), qy, hn::Mul(hn::Set(d, c[2]), qz)));
  u.y = hn::MulAdd(hn::Set(d, c[1]), qx, hn::MulAdd(hn::Set(d, c[3]), qy, hn::Mul(hn::Set(d, c[4]), qz)));
  u.z = hn::MulAdd(hn::Set(d, c[2]), qx, hn::MulAdd(hn::Set(d, c[4]), qy, hn::Mul(hn::Set(d, c[5]), qz)));
  const Vector m = hn::MulAdd(qx, u.x, hn::MulAdd(qy, u.y, hn::Mul(qz, u.z)));
  u.exponent = hn::MulAdd(m, factor, unused_lanes);
  u.q_squared = within_radius ? hn::MulAdd(qx, qx, hn::MulAdd(qy, qy, hn::Mul(qz, qz))) : m;
  return u;
}

// 0 where a vector that begins at `i` holds points before `last`, and so little beyond that 2^x vanishes.
HWY_INLINE Vector unusedLanes(Float d, std::size_t i, std::size_t last) {
  return hn::IfThenElse(hn::FirstN(d, last - i), hn::Zero(d), hn::Set(d, -1.0e30F));
}

template <bool weighted, bool within_radius>
std::size_t accumulatePairsOf(const BatchPoints& points, const float* confidence, const BatchVoxels& voxels,
                              const PairParameters& parameters, BatchSums& sums) {
  const Float d;
  const std::size_t lanes = hn::Lanes(d);
  const Vector factor = hn::Set(d, parameters.exponent_factor);
  const Vector one = hn::Set(d, 1.0F);
  const Vector least_compatibility = hn::Set(d, parameters.least_compatibility);
  const Vector mismatch_slope = hn::Set(d, parameters.mismatch_slope);
  const Vector radius_squared = hn::Set(d, parameters.radius_m * parameters.radius_m);
  std::size_t pair_count = 0;
  for (std::size_t run = 0; run < points.run_count; ++run) {
    const RunVoxel* const begin = voxels.voxels + voxels.first[run];
    const RunVoxel* const end = voxels.voxels + voxels.first[run + 1];
    const auto last = static_cast<std::size_t>(points.run_starts[run + 1]);
    for (auto i = static_cast<std::size_t>(points.run_starts[run]); i < last; i += lanes) {
      const Vector px = hn::LoadU(d, points.from_centre[0] + i);
      const Vector py = hn::LoadU(d, points.from_centre[1] + i);
      const Vector pz = hn::LoadU(d, points.from_centre[2] + i);
      const Vector unused_lanes = unusedLanes(d, i, last);
      const Vector source_confidence = weighted ? hn::LoadU(d, confidence + i) : one;
      const Vector amplitude = hn::Mul(source_confidence, hn::Set(d, parameters.amplitude));
      Vector score = hn::Zero(d), gx = score, gy = score, gz = score;
      Vector cxx = score, cxy = score, cxz = score, cyy = score, cyz = score, czz = score;
      Vector rxx = score, rxy = score, rxz = score, ryy = score, ryz = score, rzz = score;
      for (const RunVoxel* voxel = begin; voxel != end; ++voxel) {
        const PackedNdtCell& cell = parameters.cells[voxel->number];
        const Offset u = offsetFrom<within_radius>(d, *voxel, cell, px, py, pz, factor, unused_lanes);
        if (within_radius) {
          const auto within = hn::And(hn::Le(u.q_squared, radius_squared), hn::FirstN(d, last - i));
          pair_count += hn::CountTrue(d, within);
        }
        Vector e = hn::Mul(amplitude, exp2OfNegative(d, u.exponent));
        if (within_radius) e = hn::IfThenElseZero(hn::Le(u.q_squared, radius_squared), e);
        if (weighted) {
          const Vector difference = hn::Abs(hn::Sub(source_confidence, hn::Set(d, cell.mean_confidence)));
          const Vector compatibility = hn::Max(least_compatibility, hn::NegMulAdd(difference, mismatch_slope, one));
          e = hn::Mul(e, hn::Mul(compatibility, hn::Set(d, cell.weight)));
        }
        score = hn::Add(score, e);
        const Vector kx = hn::Mul(e, u.x), ky = hn::Mul(e, u.y), kz = hn::Mul(e, u.z);
        gx = hn::Add(gx, kx);
        gy = hn::Add(gy, ky);
        gz = hn::Add(gz, kz);
        const float* const c = cell.inverse_covariance;
        cxx = hn::MulAdd(e, hn::Set(d, c[0]), cxx);
        cxy = hn::MulAdd(e, hn::Set(d, c[1]), cxy);
        cxz = hn::MulAdd(e, hn::Set(d, c[2]), cxz);
        cyy = hn::MulAdd(e, hn::Set(d, c[3]), cyy);
        cyz = hn::MulAdd(e, hn::Set(d, c[4]), cyz);
        czz = hn::MulAdd(e, hn::Set(d, c[5]), czz);
        rxx = hn::MulAdd(kx, u.x, rxx);
        rxy = hn::MulAdd(kx, u.y, rxy);
        rxz = hn::MulAdd(kx, u.z, rxz);
        ryy = hn::MulAdd(ky, u.y, ryy);
        ryz = hn::MulAdd(ky, u.z, ryz);
        rzz = hn::MulAdd(kz, u.z, rzz);
      }
      // Lanes beyond the run are written over by the next one, or zeroed before they are read.
      hn::StoreU(score, d, sums.score + i);
      hn::StoreU(gx, d, sums.pull[0] + i);
      hn::StoreU(gy, d, sums.pull[1] + i);
      hn::StoreU(gz, d, sums.pull[2] + i);
      hn::StoreU(cxx, d, sums.curvature[0] + i);
      hn::StoreU(cxy, d, sums.curvature[1] + i);
      hn::StoreU(cxz, d, sums.curvature[2] + i);
      hn::StoreU(cyy, d, sums.curvature[3] + i);
      hn::StoreU(cyz, d, sums.curvature[4] + i);
      hn::StoreU(czz, d, sums.curvature[5] + i);
      hn::StoreU(rxx, d, sums.radial[0] + i);
      hn::StoreU(rxy, d, sums.radial[1] + i);
      hn::StoreU(rxz, d, sums.radial[2] + i);
      hn::StoreU(ryy, d, sums.radial[3] + i);
      hn::StoreU(ryz, d, sums.radial[4] + i);
      hn::StoreU(rzz, d, sums.radial[5] + i);
    }
    if (!within_radius) {
      pair_count += static_cast<std::size_t>(end - begin) * (last - static_cast<std::size_t>(points.run_starts[run]));
    }
  }
  return pair_count;
}

std::size_t pairs(const BatchPoints& points, const float* confidence, const BatchVoxels& voxels,
                  const PairParameters& parameters, BatchSums& sums) {
  if (parameters.within_radius) {
    return parameters.weighted ? accumulatePairsOf<true, true>(points, confidence, voxels, parameters, sums)
                               : accumulatePairsOf<false, true>(points, confidence, voxels, parameters, sums);
  }
  return parameters.weighted ? accumulatePairsOf<true, false>(points, confidence, voxels, parameters, sums)
                             : accumulatePairsOf<false, false>(points, confidence, voxels, parameters, sums);
}

HWY_INLINE void addSum(Float d, Vector v, double& sum) {
  sum += static_cast<double>(hn::GetLane(hn::SumOfLanes(d, v)));
}

// sum of J^T M J, its upper triangle row by row.
void projectMatrix(const BatchPoints& points, std::size_t count, const float m[6][kBatchRoom], double* sum) {
  const Float d;
  const std::size_t lanes = hn::Lanes(d);
  Vector xx = hn::Zero(d), xy = xx, xz = xx, yy = xx, yz = xx, zz = xx;
  Vector xa = xx, xb = xx, xc = xx, ya = xx, yb = xx, yc = xx, za = xx, zb = xx, zc = xx;
  Vector aa = xx, ab = xx, ac = xx, bb = xx, bc = xx, cc = xx;
  for (std::size_t i = 0; i < count; i += lanes) {
    const Vector x = hn::Load(d, points.rotated[0] + i), y = hn::Load(d, points.rotated[1] + i),
                 z = hn::Load(d, points.rotated[2] + i);
    const Vector mxx = hn::Load(d, m[0] + i), mxy = hn::Load(d, m[1] + i), mxz = hn::Load(d, m[2] + i);
    const Vector myy = hn::Load(d, m[3] + i), myz = hn::Load(d, m[4] + i), mzz = hn::Load(d, m[5] + i);
    xx = hn::Add(xx, mxx);
    xy = hn::Add(xy, mxy);
    xz = hn::Add(xz, mxz);
    yy = hn::Add(yy, myy);
    yz = hn::Add(yz, myz);
    zz = hn::Add(zz, mzz);
    // Column k of -M [r]x is M (e_k x r).
    const Vector txa = hn::MulSub(mxz, y, hn::Mul(mxy, z)), txb = hn::MulSub(mxx, z, hn::Mul(mxz, x)),
                 txc = hn::MulSub(mxy, x, hn::Mul(mxx, y));
    const Vector tya = hn::MulSub(myz, y, hn::Mul(myy, z)), tyb = hn::MulSub(mxy, z, hn::Mul(myz, x)),
                 tyc = hn::MulSub(myy, x, hn::Mul(mxy, y));
    const Vector tza = hn::MulSub(mzz, y, hn::Mul(myz, z)), tzb = hn::MulSub(mxz, z, hn::Mul(mzz, x)),
                 tzc = hn::MulSub(myz, x, hn::Mul(mxz, y));
    xa = hn::Add(xa, txa);
    xb = hn::Add(xb, txb);
    xc = hn::Add(xc, txc);
    ya = hn::Add(ya, tya);
    yb = hn::Add(yb, tyb);
    yc = hn::Add(yc, tyc);
    za = hn::Add(za, tza);
    zb = hn::Add(zb, tzb);
    zc = hn::Add(zc, tzc);
    // Row k of the lower right is (e_k x r)^T times that.
    aa = hn::MulAdd(tza, y, hn::NegMulAdd(tya, z, aa));
    ab = hn::MulAdd(tzb, y, hn::NegMulAdd(tyb, z, ab));
    ac = hn::MulAdd(tzc, y, hn::NegMulAdd(tyc, z, ac));
    bb = hn::MulAdd(txb, z, hn::NegMulAdd(tzb, x, bb));
    bc = hn::MulAdd(txc, z, hn::NegMulAdd(tzc, x, bc));
    cc = hn::MulAdd(tyc, x, hn::NegMulAdd(txc, y, cc));
  }
  const Vector all[21] = {xx, xy, xz, xa, xb, xc, yy, yz, ya, yb, yc, zz, za, zb, zc, aa, ab, ac, bb, bc, cc};
  for (std::size_t k = 0; k < 21; ++k) addSum(d, all[k], sum[k]);
}

void zeroBeyond(float* values, std::size_t count, std::size_t lanes) {
  for (std::size_t i = count; i % lanes != 0; ++i) values[i] = 0.0F;
}

void project(const BatchPoints& points, std::size_t count, BatchSums& sums, BatchTotals& totals) {
  const Float d;
  const std::size_t lanes = hn::Lanes(d);
  zeroBeyond(sums.score, count, lanes);
  for (auto& values : sums.pull) zeroBeyond(values, count, lanes);
  for (auto& values : sums.curvature) zeroBeyond(values, count, lanes);
  for (auto& values : sums.radial) zeroBeyond(values, count, lanes);

  Vector score = hn::Zero(d);
  for (std::size_t i = 0; i < count; i += lanes) score = hn::Add(score, hn::Load(d, sums.score + i));
  addSum(d, score, totals.score);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vector pull = hn::Zero(d), by_x = pull, by_y = pull, by_z = pull;
    for (std::size_t i = 0; i < count; i += lanes) {
      const Vector g = hn::Load(d, sums.pull[axis] + i);
      pull = hn::Add(pull, g);
      by_x = hn::MulAdd(g, hn::Load(d, points.rotated[0] + i), by_x);
      by_y = hn::MulAdd(g, hn::Load(d, points.rotated[1] + i), by_y);
      by_z = hn::MulAdd(g, hn::Load(d, points.rotated[2] + i), by_z);
    }
    addSum(d, pull, totals.pull[axis]);
    addSum(d, by_x, totals.moment[3 * axis]);
    addSum(d, by_y, totals.moment[3 * axis + 1]);
    addSum(d, by_z, totals.moment[3 * axis + 2]);
  }
  projectMatrix(points, count, sums.curvature, totals.curvature);
  projectMatrix(points, count, sums.radial, totals.radial);
}

void scores(const BatchPoints& points, const BatchVoxels& voxels, const PairParameters& parameters, float* total,
            float* best) {
  const Float d;
  const std::size_t lanes = hn::Lanes(d);
  const Vector factor = hn::Set(d, parameters.exponent_factor);
  const Vector amplitude = hn::Set(d, parameters.amplitude);
  for (std::size_t run = 0; run < points.run_count; ++run) {
    const RunVoxel* const begin = voxels.voxels + voxels.first[run];
    const RunVoxel* const end = voxels.voxels + voxels.first[run + 1];
    const auto last = static_cast<std::size_t>(points.run_starts[run + 1]);
    for (auto i = static_cast<std::size_t>(points.run_starts[run]); i < last; i += lanes) {
      const Vector px = hn::LoadU(d, points.from_centre[0] + i);
      const Vector py = hn::LoadU(d, points.from_centre[1] + i);
      const Vector pz = hn::LoadU(d, points.from_centre[2] + i);
      Vector sum = hn::Zero(d), greatest = hn::Zero(d);
      for (const RunVoxel* voxel = begin; voxel != end; ++voxel) {
        const Offset u = offsetFrom<false>(d, *voxel, parameters.cells[voxel->number], px, py, pz, factor, hn::Zero(d));
        const Vector e = hn::Mul(amplitude, exp2OfNegative(d, u.exponent));
        sum = hn::Add(sum, e);
        greatest = hn::Max(greatest, e);
      }
      hn::StoreU(sum, d, total + i);
      hn::StoreU(greatest, d, best + i);
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace saw_ndt
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace saw_ndt {

HWY_EXPORT(columnsOf);
HWY_EXPORT(transform);
HWY_EXPORT(pairs);
HWY_EXPORT(project);
HWY_EXPORT(scores);

void transformBatch(const float* x, const float* y, const float* z, std::size_t count, const BatchPose& pose,
                    BatchPoints& points) {
  SAW_NDT_DISPATCH(transform)(x, y, z, count, pose, points);
}

void findColumns(const float* x, const float* y, std::size_t count, float inverse_column_m, std::uint16_t* columns) {
  SAW_NDT_DISPATCH(columnsOf)(x, y, count, inverse_column_m, columns);
}

std::size_t accumulatePairs(const BatchPoints& points, const float* confidence, const BatchVoxels& voxels,
                            const PairParameters& parameters, BatchSums& sums) {
  return SAW_NDT_DISPATCH(pairs)(points, confidence, voxels, parameters, sums);
}

void addProjectedSums(const BatchPoints& points, std::size_t count, BatchSums& sums, BatchTotals& totals) {
  SAW_NDT_DISPATCH(project)(points, count, sums, totals);
}

void accumulateScores(const BatchPoints& points, const BatchVoxels& voxels, const PairParameters& parameters,
                      float* total, float* best) {
  SAW_NDT_DISPATCH(scores)(points, voxels, parameters, total, best);
}

}  // namespace saw_ndt
#endif
