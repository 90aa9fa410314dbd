#include "registration/ndt_kernel.h"

#include <cstddef>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "registration/ndt_kernel.cpp"
#include "common/vector_dispatch.h"

HWY_BEFORE_NAMESPACE();
namespace saw_ndt::internal {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Float = hn::CappedTag<float, kMostLanes>;
using Int = hn::RebindToSigned<Float>;
using Vector = hn::Vec<Float>;

// Less is raised to this: 2^-60 adds nothing, and its products are no subnormal numbers, which would slow everything
// down.
constexpr float kMinExponent = -60.0F;

// 2^x for x <= 0, to 2e-7 of its value: x = n + f with |f| <= 1/2; a minimax polynomial of f, whose exponent n is added
// to. Adding kRound leaves n in the lowest bits of a float.
HWY_INLINE Vector exp2OfNegative(Float d, Vector x) {
  constexpr float kRound = 12582912.0F;  // 1.5 * 2^23
  const Int di;
  x = hn::Max(x, hn::Set(d, kMinExponent));
  const Vector shifted = hn::Add(x, hn::Set(d, kRound));
  const Vector f = hn::Sub(x, hn::Sub(shifted, hn::Set(d, kRound)));
  Vector p = hn::MulAdd(f, hn::Set(d, 0.0013264727F), hn::Set(d, 0.0096715128F));
  p = hn::MulAdd(f, p, hn::Set(d, 0.0555073374F));
  p = hn::MulAdd(f, p, hn::Set(d, 0.2402224208F));
  p = hn::MulAdd(f, p, hn::Set(d, 0.6931469776F));
  p = hn::MulAdd(f, p, hn::Set(d, 1.0F));
  return hn::BitCast(d, hn::Add(hn::BitCast(di, p), hn::ShiftLeft<23>(hn::BitCast(di, shifted))));
}

#if HWY_TARGET == HWY_SCALAR
constexpr std::size_t kPointsPerUnit = 1;
#else
constexpr std::size_t kPointsPerUnit = 4;
#endif
constexpr std::size_t kUnitsPerVector = hn::MaxLanes(Float()) / kPointsPerUnit;

std::size_t unitSize() { return kPointsPerUnit; }
std::size_t unitsInVector() { return kUnitsPerVector; }

// Four values for each unit of a vector, and one of them in all lanes of its unit.
#if HWY_TARGET == HWY_SCALAR
using Quads = const float*;
template <typename Address>
HWY_INLINE Quads loadQuads(Float /*d*/, const Address& address) {
  return address(0);
}
template <int kValue>
HWY_INLINE Vector valueOf(Float d, Quads quads) {
  return hn::Set(d, quads[kValue]);
}
template <typename Address>
HWY_INLINE Vector loadUnits(Float d, const Address& address) {
  return hn::LoadU(d, address(0));
}
#else
using Quads = Vector;
template <typename Address>
HWY_INLINE Vector loadUnits(Float d, const Address& address) {
  const hn::Full128<float> d128;
  if constexpr (kUnitsPerVector == 1) {
    return hn::LoadU(d, address(0));
  } else if constexpr (kUnitsPerVector == 2) {
    return hn::Combine(d, hn::LoadU(d128, address(1)), hn::LoadU(d128, address(0)));
  } else {
    const hn::Half<Float> d256;
    return hn::Combine(d, hn::Combine(d256, hn::LoadU(d128, address(3)), hn::LoadU(d128, address(2))),
                       hn::Combine(d256, hn::LoadU(d128, address(1)), hn::LoadU(d128, address(0))));
  }
}
template <typename Address>
HWY_INLINE Quads loadQuads(Float d, const Address& address) {
  return loadUnits(d, address);
}
template <int kValue>
HWY_INLINE Vector valueOf(Float /*d*/, Quads quads) {
  return hn::Broadcast<kValue>(quads);
}
#endif

// 1 in the lanes that hold a point of a unit of so many points.
alignas(16) constexpr float kUsedLanes[5][4] = {{0, 0, 0, 0}, {1, 0, 0, 0}, {1, 1, 0, 0}, {1, 1, 1, 0}, {1, 1, 1, 1}};

HWY_INLINE Vector usedLanes(Float d, const PointUnit* units) {
  return loadUnits(d, [&](std::size_t k) HWY_ATTR { return kUsedLanes[units[k].point_count]; });
}

HWY_INLINE Vector valuesOf(Float d, const float* values, const PointUnit* units) {
  return loadUnits(d, [&](std::size_t k) HWY_ATTR { return values + units[k].first_point; });
}

// A voxel of each unit of a vector, broadcast.
struct UnitVoxels {
  Vector mean[3];
  Vector c[6];
  Vector weight, confidence;
};

static_assert(offsetof(internal::PackedNdtCell, mean_confidence) == 10 * sizeof(float));

HWY_INLINE UnitVoxels loadVoxels(Float d, const PointUnit* units, std::size_t n, const RunVoxel* voxels,
                                 const internal::PackedNdtCell* cells) {
  const auto voxel = [&](std::size_t k) HWY_ATTR { return voxels + units[k].first_voxel + n; };
  const auto cell = [&](std::size_t k) HWY_ATTR { return reinterpret_cast<const float*>(cells + voxel(k)->number); };
  const Quads mean = loadQuads(d, [&](std::size_t k) HWY_ATTR { return voxel(k)->mean; });
  const Quads first = loadQuads(d, [&](std::size_t k) HWY_ATTR { return cell(k) + 3; });
  const Quads second = loadQuads(d, [&](std::size_t k) HWY_ATTR { return cell(k) + 7; });
  return {{valueOf<0>(d, mean), valueOf<1>(d, mean), valueOf<2>(d, mean)},
          {valueOf<0>(d, first), valueOf<1>(d, first), valueOf<2>(d, first), valueOf<3>(d, first),
           valueOf<0>(d, second), valueOf<1>(d, second)},
          valueOf<2>(d, second),
          valueOf<3>(d, second)};
}

// q, C^-1 q and the squared Mahalanobis distance of each point of a vector.
struct Offset {
  Vector qx, qy, qz;
  Vector x, y, z;
  Vector squared_mahalanobis;
};

HWY_INLINE Offset offsetFrom(const UnitVoxels& v, Vector px, Vector py, Vector pz) {
  Offset u;
  u.qx = hn::Sub(px, v.mean[0]);
  u.qy = hn::Sub(py, v.mean[1]);
  u.qz = hn::Sub(pz, v.mean[2]);
  u.x = hn::MulAdd(v.c[0], u.qx, hn::MulAdd(v.c[1], u.qy, hn::Mul(v.c[2], u.qz)));
  u.y = hn::MulAdd(v.c[1], u.qx, hn::MulAdd(v.c[3], u.qy, hn::Mul(v.c[4], u.qz)));
  u.z = hn::MulAdd(v.c[2], u.qx, hn::MulAdd(v.c[4], u.qy, hn::Mul(v.c[5], u.qz)));
  u.squared_mahalanobis = hn::MulAdd(u.qx, u.x, hn::MulAdd(u.qy, u.y, hn::Mul(u.qz, u.z)));
  return u;
}

// Sums over the pairs of each point of some vectors of units, which stay in the first-level cache.
constexpr std::size_t kLanesPerPass = 512;
constexpr std::size_t kUnitsPerPass = kLanesPerPass / kPointsPerUnit;
struct alignas(64) PointSums {
  float score[kLanesPerPass];
  float pull[3][kLanesPerPass];
  float curvature[6][kLanesPerPass];
  float radial[6][kLanesPerPass];
};

template <bool weighted, bool within_radius>
std::size_t sumPairs(const BatchPoints& points, const float* confidence, const PointUnit* units, std::size_t unit_count,
                     const RunVoxel* voxels, const PairParameters& parameters, PointSums& sums) {
  const Float d;
  const Vector factor = hn::Set(d, parameters.exponent_factor);
  const Vector one = hn::Set(d, 1.0F);
  const Vector min_compatibility = hn::Set(d, parameters.min_compatibility);
  const Vector mismatch_slope = hn::Set(d, parameters.mismatch_slope);
  const Vector radius_squared = hn::Set(d, parameters.radius_m * parameters.radius_m);
  std::size_t pair_count = 0;
  for (std::size_t u0 = 0; u0 < unit_count; u0 += kUnitsPerVector) {
    const PointUnit* const unit = units + u0;
    const Vector px = valuesOf(d, points.from_centre[0], unit);
    const Vector py = valuesOf(d, points.from_centre[1], unit);
    const Vector pz = valuesOf(d, points.from_centre[2], unit);
    const Vector used = usedLanes(d, unit);
    const Vector source_confidence = weighted ? valuesOf(d, confidence, unit) : one;
    Vector amplitude = hn::Mul(used, hn::Set(d, parameters.amplitude));
    if (weighted) amplitude = hn::Mul(amplitude, source_confidence);
    Vector score = hn::Zero(d), gx = score, gy = score, gz = score;
    Vector cxx = score, cxy = score, cxz = score, cyy = score, cyz = score, czz = score;
    Vector rxx = score, rxy = score, rxz = score, ryy = score, ryz = score, rzz = score;
    const std::size_t voxel_count = unit->voxel_count;
    for (std::size_t n = 0; n < voxel_count; ++n) {
      const UnitVoxels v = loadVoxels(d, unit, n, voxels, parameters.cells);
      const Offset u = offsetFrom(v, px, py, pz);
      Vector e = hn::Mul(amplitude, exp2OfNegative(d, hn::Mul(u.squared_mahalanobis, factor)));
      if (within_radius) {
        const Vector q_squared = hn::MulAdd(u.qx, u.qx, hn::MulAdd(u.qy, u.qy, hn::Mul(u.qz, u.qz)));
        const auto within = hn::Le(q_squared, radius_squared);
        pair_count += hn::CountTrue(d, hn::And(within, hn::Gt(used, hn::Zero(d))));
        e = hn::IfThenElseZero(within, e);
      }
      if (weighted) {
        const Vector difference = hn::Abs(hn::Sub(source_confidence, v.confidence));
        const Vector compatibility = hn::Max(min_compatibility, hn::NegMulAdd(difference, mismatch_slope, one));
        e = hn::Mul(e, hn::Mul(compatibility, v.weight));
      }
      score = hn::Add(score, e);
      const Vector kx = hn::Mul(e, u.x), ky = hn::Mul(e, u.y), kz = hn::Mul(e, u.z);
      gx = hn::Add(gx, kx);
      gy = hn::Add(gy, ky);
      gz = hn::Add(gz, kz);
      cxx = hn::MulAdd(e, v.c[0], cxx);
      cxy = hn::MulAdd(e, v.c[1], cxy);
      cxz = hn::MulAdd(e, v.c[2], cxz);
      cyy = hn::MulAdd(e, v.c[3], cyy);
      cyz = hn::MulAdd(e, v.c[4], cyz);
      czz = hn::MulAdd(e, v.c[5], czz);
      rxx = hn::MulAdd(kx, u.x, rxx);
      rxy = hn::MulAdd(kx, u.y, rxy);
      rxz = hn::MulAdd(kx, u.z, rxz);
      ryy = hn::MulAdd(ky, u.y, ryy);
      ryz = hn::MulAdd(ky, u.z, ryz);
      rzz = hn::MulAdd(kz, u.z, rzz);
    }
    const std::size_t i = u0 * kPointsPerUnit;
    hn::Store(score, d, sums.score + i);
    hn::Store(gx, d, sums.pull[0] + i);
    hn::Store(gy, d, sums.pull[1] + i);
    hn::Store(gz, d, sums.pull[2] + i);
    hn::Store(cxx, d, sums.curvature[0] + i);
    hn::Store(cxy, d, sums.curvature[1] + i);
    hn::Store(cxz, d, sums.curvature[2] + i);
    hn::Store(cyy, d, sums.curvature[3] + i);
    hn::Store(cyz, d, sums.curvature[4] + i);
    hn::Store(czz, d, sums.curvature[5] + i);
    hn::Store(rxx, d, sums.radial[0] + i);
    hn::Store(rxy, d, sums.radial[1] + i);
    hn::Store(rxz, d, sums.radial[2] + i);
    hn::Store(ryy, d, sums.radial[3] + i);
    hn::Store(ryz, d, sums.radial[4] + i);
    hn::Store(rzz, d, sums.radial[5] + i);
    if (!within_radius) {
      for (std::size_t k = 0; k < kUnitsPerVector; ++k) pair_count += unit[k].point_count * voxel_count;
    }
  }
  return pair_count;
}

HWY_INLINE void addSum(Float d, Vector v, double& sum) {
  sum += static_cast<double>(hn::GetLane(hn::SumOfLanes(d, v)));
}

// sum of J^T M J, its upper triangle row by row.
void projectMatrix(const BatchPoints& points, const PointUnit* units, std::size_t unit_count,
                   const float m[6][kLanesPerPass], double* sum) {
  const Float d;
  Vector xx = hn::Zero(d), xy = xx, xz = xx, yy = xx, yz = xx, zz = xx;
  Vector xa = xx, xb = xx, xc = xx, ya = xx, yb = xx, yc = xx, za = xx, zb = xx, zc = xx;
  Vector aa = xx, ab = xx, ac = xx, bb = xx, bc = xx, cc = xx;
  for (std::size_t u0 = 0; u0 < unit_count; u0 += kUnitsPerVector) {
    const std::size_t i = u0 * kPointsPerUnit;
    const Vector x = valuesOf(d, points.rotated[0], units + u0), y = valuesOf(d, points.rotated[1], units + u0),
                 z = valuesOf(d, points.rotated[2], units + u0);
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

void project(const BatchPoints& points, const PointUnit* units, std::size_t unit_count, const PointSums& sums,
             BatchTotals& totals) {
  const Float d;
  Vector score = hn::Zero(d);
  for (std::size_t u0 = 0; u0 < unit_count; u0 += kUnitsPerVector) {
    score = hn::Add(score, hn::Load(d, sums.score + u0 * kPointsPerUnit));
  }
  addSum(d, score, totals.score);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vector pull = hn::Zero(d), by_x = pull, by_y = pull, by_z = pull;
    for (std::size_t u0 = 0; u0 < unit_count; u0 += kUnitsPerVector) {
      const Vector g = hn::Load(d, sums.pull[axis] + u0 * kPointsPerUnit);
      pull = hn::Add(pull, g);
      by_x = hn::MulAdd(g, valuesOf(d, points.rotated[0], units + u0), by_x);
      by_y = hn::MulAdd(g, valuesOf(d, points.rotated[1], units + u0), by_y);
      by_z = hn::MulAdd(g, valuesOf(d, points.rotated[2], units + u0), by_z);
    }
    addSum(d, pull, totals.pull[axis]);
    addSum(d, by_x, totals.moment[3 * axis]);
    addSum(d, by_y, totals.moment[3 * axis + 1]);
    addSum(d, by_z, totals.moment[3 * axis + 2]);
  }
  projectMatrix(points, units, unit_count, sums.curvature, totals.curvature);
  projectMatrix(points, units, unit_count, sums.radial, totals.radial);
}

template <bool weighted, bool within_radius>
BatchTotals evaluatePairsOf(const BatchPoints& points, const float* confidence, const BatchUnits& units,
                            const BatchVoxels& voxels, const PairParameters& parameters) {
  BatchTotals totals{};
  PointSums sums;
  for (std::size_t first = 0; first < units.count; first += kUnitsPerPass) {
    const std::size_t count = HWY_MIN(kUnitsPerPass, units.count - first);
    totals.pair_count += sumPairs<weighted, within_radius>(points, confidence, units.units + first, count,
                                                           voxels.voxels, parameters, sums);
    project(points, units.units + first, count, sums, totals);
  }
  return totals;
}

BatchTotals pairs(const BatchPoints& points, const float* confidence, const BatchUnits& units,
                  const BatchVoxels& voxels, const PairParameters& parameters) {
  if (parameters.within_radius) {
    return parameters.weighted ? evaluatePairsOf<true, true>(points, confidence, units, voxels, parameters)
                               : evaluatePairsOf<false, true>(points, confidence, units, voxels, parameters);
  }
  return parameters.weighted ? evaluatePairsOf<true, false>(points, confidence, units, voxels, parameters)
                             : evaluatePairsOf<false, false>(points, confidence, units, voxels, parameters);
}

BatchScores scores(const BatchPoints& points, const float* non_ground, const BatchUnits& units,
                   const BatchVoxels& voxels, const PairParameters& parameters) {
  const Float d;
  const Vector factor = hn::Set(d, parameters.exponent_factor);
  Vector all = hn::Zero(d), all_non_ground = hn::Zero(d), best = hn::Zero(d);
  for (std::size_t u0 = 0; u0 < units.count; u0 += kUnitsPerVector) {
    const PointUnit* const unit = units.units + u0;
    const Vector px = valuesOf(d, points.from_centre[0], unit);
    const Vector py = valuesOf(d, points.from_centre[1], unit);
    const Vector pz = valuesOf(d, points.from_centre[2], unit);
    Vector sum = hn::Zero(d), greatest = hn::Zero(d);
    const std::size_t voxel_count = unit->voxel_count;
    for (std::size_t n = 0; n < voxel_count; ++n) {
      const Offset u = offsetFrom(loadVoxels(d, unit, n, voxels.voxels, parameters.cells), px, py, pz);
      const Vector e = exp2OfNegative(d, hn::Mul(u.squared_mahalanobis, factor));
      sum = hn::Add(sum, e);
      greatest = hn::Max(greatest, e);
    }
    const Vector used = usedLanes(d, unit);
    sum = hn::Mul(used, sum);
    all = hn::Add(all, sum);
    all_non_ground = hn::MulAdd(sum, valuesOf(d, non_ground, unit), all_non_ground);
    best = hn::MulAdd(used, greatest, best);
  }
  BatchScores result{};
  addSum(d, all, result.all);
  addSum(d, all_non_ground, result.non_ground);
  addSum(d, best, result.best);
  const auto amplitude = static_cast<double>(parameters.amplitude);
  return {amplitude * result.all, amplitude * result.non_ground, amplitude * result.best};
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace saw_ndt::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace saw_ndt::internal {

HWY_EXPORT(pairs);
HWY_EXPORT(scores);
HWY_EXPORT(unitSize);
HWY_EXPORT(unitsInVector);

std::size_t pointsPerUnit() { return SAW_NDT_DISPATCH(unitSize)(); }
std::size_t unitsPerVector() { return SAW_NDT_DISPATCH(unitsInVector)(); }

BatchTotals evaluatePairs(const BatchPoints& points, const float* confidence, const BatchUnits& units,
                          const BatchVoxels& voxels, const PairParameters& parameters) {
  return SAW_NDT_DISPATCH(pairs)(points, confidence, units, voxels, parameters);
}

BatchScores evaluateScores(const BatchPoints& points, const float* non_ground, const BatchUnits& units,
                           const BatchVoxels& voxels, const PairParameters& parameters) {
  return SAW_NDT_DISPATCH(scores)(points, non_ground, units, voxels, parameters);
}

}  // namespace saw_ndt::internal
#endif
