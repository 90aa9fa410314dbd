#include "map/symmetric_eigen.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "map/symmetric_eigen.cpp"
#include "common/vector_dispatch.h"

HWY_BEFORE_NAMESPACE();
namespace saw_ndt::internal {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;

// With elements below 2, what is left off the diagonal then moves no eigenvalue by a rounding error.
constexpr double kNegligible = 0x1p-58;
// Convergence is quadratic: four sweeps are the rule.
constexpr int kMostSweeps = 16;

struct Vector {
  V x, y, z;
};

// Turns the plane of p and q.
HWY_INLINE void turn(V cosine, V sine, V& p, V& q) {
  const V turned = hn::Sub(hn::Mul(cosine, p), hn::Mul(sine, q));
  q = hn::Add(hn::Mul(sine, p), hn::Mul(cosine, q));
  p = turned;
}

// The Jacobi rotation that makes pq zero; r is the third row. A matrix whose pq is negligible already stays exactly as
// it is, so that it does not matter how many sweeps the others still need.
HWY_INLINE void eliminate(V& pp, V& pq, V& qq, V& pr, V& qr, Vector& p, Vector& q) {
  const D d;
  const auto acts = hn::Gt(hn::Abs(pq), hn::Set(d, kNegligible));
  const V difference = hn::Sub(qq, pp);
  const V twice = hn::Add(pq, pq);
  const V length = hn::Sqrt(hn::Add(hn::Mul(difference, difference), hn::Mul(twice, twice)));
  const V magnitude = hn::Div(twice, hn::Add(hn::Abs(difference), length));
  const V tangent =
      hn::IfThenElseZero(acts, hn::IfThenElse(hn::Lt(difference, hn::Zero(d)), hn::Neg(magnitude), magnitude));
  const V one = hn::Set(d, 1.0);
  const V cosine = hn::Div(one, hn::Sqrt(hn::Add(hn::Mul(tangent, tangent), one)));
  const V sine = hn::Mul(tangent, cosine);
  const V shift = hn::Mul(tangent, pq);
  pp = hn::Sub(pp, shift);
  qq = hn::Add(qq, shift);
  pq = hn::IfThenZeroElse(acts, pq);
  turn(cosine, sine, pr, qr);
  turn(cosine, sine, p.x, q.x);
  turn(cosine, sine, p.y, q.y);
  turn(cosine, sine, p.z, q.z);
}

// The greatest power of two that no element exceeds in magnitude, 1 for a zero matrix: dividing by it rounds nothing.
HWY_INLINE V scaleOf(V xx, V xy, V xz, V yy, V yz, V zz) {
  const D d;
  const hn::RebindToUnsigned<D> bits;
  const V greatest = hn::Max(hn::Max(hn::Max(hn::Abs(xx), hn::Abs(xy)), hn::Max(hn::Abs(xz), hn::Abs(yy))),
                             hn::Max(hn::Abs(yz), hn::Abs(zz)));
  const V power = hn::BitCast(d, hn::And(hn::BitCast(bits, greatest), hn::Set(bits, 0x7FF0000000000000ULL)));
  return hn::IfThenElse(hn::Gt(power, hn::Zero(d)), power, hn::Set(d, 1.0));
}

HWY_INLINE void storeVector(const Vector& v, double (&to)[3][SymmetricMatrices::kMost], std::size_t at) {
  const D d;
  hn::Store(v.x, d, to[0] + at);
  hn::Store(v.y, d, to[1] + at);
  hn::Store(v.z, d, to[2] + at);
}

void decompose(SymmetricMatrices& matrices, std::size_t count) {
  const D d;
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0), negligible = hn::Set(d, kNegligible);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    V xx = hn::Load(d, matrices.element[0] + i), xy = hn::Load(d, matrices.element[1] + i),
      xz = hn::Load(d, matrices.element[2] + i), yy = hn::Load(d, matrices.element[3] + i),
      yz = hn::Load(d, matrices.element[4] + i), zz = hn::Load(d, matrices.element[5] + i);
    const V scale = scaleOf(xx, xy, xz, yy, yz, zz), inverse_scale = hn::Div(one, scale);
    xx = hn::Mul(xx, inverse_scale);
    xy = hn::Mul(xy, inverse_scale);
    xz = hn::Mul(xz, inverse_scale);
    yy = hn::Mul(yy, inverse_scale);
    yz = hn::Mul(yz, inverse_scale);
    zz = hn::Mul(zz, inverse_scale);
    Vector x{one, zero, zero}, y{zero, one, zero}, z{zero, zero, one};
    for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
      const V off_diagonal = hn::Max(hn::Max(hn::Abs(xy), hn::Abs(xz)), hn::Abs(yz));
      if (hn::AllFalse(d, hn::Gt(off_diagonal, negligible))) break;
      eliminate(xx, xy, yy, xz, yz, x, y);
      eliminate(xx, xz, zz, xy, yz, x, z);
      eliminate(yy, yz, zz, xy, xz, y, z);
    }
    hn::Store(hn::Mul(xx, scale), d, matrices.eigenvalue[0] + i);
    hn::Store(hn::Mul(yy, scale), d, matrices.eigenvalue[1] + i);
    hn::Store(hn::Mul(zz, scale), d, matrices.eigenvalue[2] + i);
    storeVector(x, matrices.eigenvector[0], i);
    storeVector(y, matrices.eigenvector[1], i);
    storeVector(z, matrices.eigenvector[2], i);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace saw_ndt::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace saw_ndt::internal {

HWY_EXPORT(decompose);

void findEigenvectors(SymmetricMatrices& matrices, std::size_t count) {
  // The rest of the last vector.
  for (auto& element : matrices.element) {
    for (std::size_t i = count; i % 8 != 0; ++i) element[i] = 0.0;
  }
  SAW_NDT_DISPATCH(decompose)(matrices, count);
}

}  // namespace saw_ndt::internal
#endif
