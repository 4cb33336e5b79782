// Vectors and quaternions of core/geometry/vec3.hpp with a body or pair in each lane: the same operations in the same order, none of them
// fused, so that each lane has the bits of the plain code. Included once for every instruction set by what is compiled for each of them
// (Highway's foreach_target).
#if defined(SCREE_SOLVER_BODIES_LANES_INL_HPP_) == defined(HWY_TARGET_TOGGLE)
#ifdef SCREE_SOLVER_BODIES_LANES_INL_HPP_
#undef SCREE_SOLVER_BODIES_LANES_INL_HPP_
#else
#define SCREE_SOLVER_BODIES_LANES_INL_HPP_
#endif

#include <hwy/highway.h>

#include <cstddef>

#include "core/distance/simd-inl.hpp"
#include "core/geometry/vec3.hpp"

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {

using Lane = Pack<double>;
/// Vectors of a length that is known as the program is built, at most 8.
constexpr std::size_t kLanes = hn::MaxLanes(Tag<double>());
static_assert(kLanes <= 8);

HWY_INLINE Mask<double> equal(Lane a, Lane b) { return {hn::Eq(a.v, b.v)}; }

struct Lane3 {
  Lane x, y, z;
};
HWY_INLINE Lane3 operator+(const Lane3& a, const Lane3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
HWY_INLINE Lane3 operator-(const Lane3& a, const Lane3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
HWY_INLINE Lane3 operator-(const Lane3& a) { return {-a.x, -a.y, -a.z}; }
HWY_INLINE Lane3 operator*(Lane s, const Lane3& a) { return {s * a.x, s * a.y, s * a.z}; }
HWY_INLINE Lane dot(const Lane3& a, const Lane3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
HWY_INLINE Lane3 cross(const Lane3& a, const Lane3& b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
HWY_INLINE Lane length(const Lane3& a) { return sqrt(dot(a, a)); }
HWY_INLINE Lane3 select(Mask<double> m, const Lane3& yes, const Lane3& no) {
  return {select(m, yes.x, no.x), select(m, yes.y, no.y), select(m, yes.z, no.z)};
}

struct LaneQuat {
  Lane w, x, y, z;
};
HWY_INLINE LaneQuat operator*(const LaneQuat& a, const LaneQuat& b) {
  return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
          a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}
HWY_INLINE LaneQuat conjugate(const LaneQuat& q) { return {q.w, -q.x, -q.y, -q.z}; }
HWY_INLINE Mask<double> equal(const LaneQuat& a, const LaneQuat& b) {
  return equal(a.w, b.w) & equal(a.x, b.x) & equal(a.y, b.y) & equal(a.z, b.z);
}
HWY_INLINE Lane3 rotate(const LaneQuat& q, const Lane3& v) {
  const Lane3 u{q.x, q.y, q.z}, t = Lane(2.0) * cross(u, v);
  return v + q.w * t + cross(u, t);
}
HWY_INLINE Lane3 rotate_inverse(const LaneQuat& q, const Lane3& v) { return rotate(conjugate(q), v); }

// what laws are written in (solver/laws/real.hpp)
using Real = Lane;
using Real3 = Lane3;
using RealQuat = LaneQuat;
using Truth = Mask<double>;

// NOLINTNEXTLINE(google-readability-namespace-comments)
}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
