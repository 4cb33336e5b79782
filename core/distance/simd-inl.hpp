// One pair of triangles per lane: operators for Highway vectors, so that a kernel reads like algebra.
//
// Included once per SIMD target by triangle_distance.cpp (Highway's foreach_target). Every fused multiply-add
// is written (mul_add and its kin): targets that have one (AVX2, AVX-512, NEON) give the same bits. SSE4 and
// the baseline round twice instead. Vectors are struct members here, so the sizeless ones (SVE, RVV) are out.
#if defined(SCREE_CORE_DISTANCE_SIMD_INL_HPP_) == defined(HWY_TARGET_TOGGLE)
#ifdef SCREE_CORE_DISTANCE_SIMD_INL_HPP_
#undef SCREE_CORE_DISTANCE_SIMD_INL_HPP_
#else
#define SCREE_CORE_DISTANCE_SIMD_INL_HPP_
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class T>
using Tag = hn::ScalableTag<T>;

template <class T>
struct Mask {
  hn::Mask<Tag<T>> m;
};
template <class T>
HWY_INLINE Mask<T> operator&(Mask<T> a, Mask<T> b) {
  return {hn::And(a.m, b.m)};
}
template <class T>
HWY_INLINE Mask<T> operator|(Mask<T> a, Mask<T> b) {
  return {hn::Or(a.m, b.m)};
}
template <class T>
HWY_INLINE Mask<T> operator!(Mask<T> a) {
  return {hn::Not(a.m)};
}
template <class T>
HWY_INLINE bool any(Mask<T> a) {
  return !hn::AllFalse(Tag<T>(), a.m);
}

template <class T>
struct Pack {
  using Value = T;
  hn::Vec<Tag<T>> v;
  Pack() = default;
  HWY_INLINE Pack(hn::Vec<Tag<T>> x) : v(x) {}
  HWY_INLINE Pack(T x) : v(hn::Set(Tag<T>(), x)) {}
  static HWY_INLINE Pack load(const T* from) { return hn::LoadU(Tag<T>(), from); }
  HWY_INLINE void store(T* to) const { hn::StoreU(v, Tag<T>(), to); }
};
template <class T>
HWY_INLINE std::int64_t lane_count() {
  return static_cast<std::int64_t>(hn::Lanes(Tag<T>()));
}

template <class T>
HWY_INLINE Pack<T> operator+(Pack<T> a, Pack<T> b) {
  return hn::Add(a.v, b.v);
}
template <class T>
HWY_INLINE Pack<T> operator-(Pack<T> a, Pack<T> b) {
  return hn::Sub(a.v, b.v);
}
template <class T>
HWY_INLINE Pack<T> operator*(Pack<T> a, Pack<T> b) {
  return hn::Mul(a.v, b.v);
}
template <class T>
HWY_INLINE Pack<T> operator/(Pack<T> a, Pack<T> b) {
  return hn::Div(a.v, b.v);
}
template <class T>
HWY_INLINE Pack<T> operator-(Pack<T> a) {
  return hn::Neg(a.v);
}
template <class T>
HWY_INLINE Mask<T> operator<(Pack<T> a, Pack<T> b) {
  return {hn::Lt(a.v, b.v)};
}
template <class T>
HWY_INLINE Mask<T> operator<=(Pack<T> a, Pack<T> b) {
  return {hn::Le(a.v, b.v)};
}
template <class T>
HWY_INLINE Mask<T> operator>(Pack<T> a, Pack<T> b) {
  return {hn::Gt(a.v, b.v)};
}
template <class T>
HWY_INLINE Mask<T> operator>=(Pack<T> a, Pack<T> b) {
  return {hn::Ge(a.v, b.v)};
}

/// a b + c
template <class T>
HWY_INLINE Pack<T> mul_add(Pack<T> a, Pack<T> b, Pack<T> c) {
  return hn::MulAdd(a.v, b.v, c.v);
}
/// a b - c
template <class T>
HWY_INLINE Pack<T> mul_sub(Pack<T> a, Pack<T> b, Pack<T> c) {
  return hn::MulSub(a.v, b.v, c.v);
}
/// c - a b
template <class T>
HWY_INLINE Pack<T> neg_mul_add(Pack<T> a, Pack<T> b, Pack<T> c) {
  return hn::NegMulAdd(a.v, b.v, c.v);
}
/// -a b - c
template <class T>
HWY_INLINE Pack<T> neg_mul_sub(Pack<T> a, Pack<T> b, Pack<T> c) {
  return hn::NegMulSub(a.v, b.v, c.v);
}
template <class T>
HWY_INLINE Pack<T> min(Pack<T> a, Pack<T> b) {
  return hn::Min(a.v, b.v);
}
template <class T>
HWY_INLINE Pack<T> max(Pack<T> a, Pack<T> b) {
  return hn::Max(a.v, b.v);
}
template <class T>
HWY_INLINE Pack<T> abs(Pack<T> a) {
  return hn::Abs(a.v);
}
template <class T>
HWY_INLINE Pack<T> sqrt(Pack<T> a) {
  return hn::Sqrt(a.v);
}
template <class T>
HWY_INLINE Pack<T> select(Mask<T> m, Pack<T> yes, Pack<T> no) {
  return hn::IfThenElse(m.m, yes.v, no.v);
}
/// select with a zero on one side: a mask alone, which any pipe of the processor takes.
template <class T>
HWY_INLINE Pack<T> where(Mask<T> m, Pack<T> yes) {
  return hn::IfThenElseZero(m.m, yes.v);
}
template <class T>
HWY_INLINE Pack<T> where_not(Mask<T> m, Pack<T> no) {
  return hn::IfThenZeroElse(m.m, no.v);
}
/// The argument is never NaN: how Min and Max treat NaN differs between targets.
template <class T>
HWY_INLINE Pack<T> clamp01(Pack<T> x) {
  return min(max(x, Pack<T>(T(0))), Pack<T>(T(1)));
}

// Predicates in the sign bit, a third of the cost of masks. They see -0 as negative.
template <class T>
HWY_INLINE Pack<T> sign_all_equal(Pack<T> a, Pack<T> b, Pack<T> c) {
  return hn::Not(hn::Or(hn::Xor(a.v, b.v), hn::Xor(b.v, c.v)));
}
template <class T>
HWY_INLINE Pack<T> sign_differs_and(Pack<T> condition, Pack<T> a, Pack<T> b) {
  return hn::And(condition.v, hn::Xor(a.v, b.v));
}
template <class T>
HWY_INLINE Pack<T> sign_or(Pack<T> a, Pack<T> b, Pack<T> c) {
  return hn::Or(a.v, hn::Or(b.v, c.v));
}
template <class T>
HWY_INLINE Pack<T> sign_or(Pack<T> a, Pack<T> b) {
  return hn::Or(a.v, b.v);
}
template <class T>
HWY_INLINE Pack<T> sign_and(Pack<T> a, Pack<T> b) {
  return hn::And(a.v, b.v);
}
template <class T>
HWY_INLINE Pack<T> sign_not(Pack<T> a) {
  return hn::Not(a.v);
}
/// The bits may be those of a NaN, so the sign is tested as an integer's.
template <class T>
HWY_INLINE Mask<T> mask_of_sign(Pack<T> a) {
  const hn::RebindToSigned<Tag<T>> integers;
  return {hn::RebindMask(Tag<T>(), hn::Lt(hn::BitCast(integers, a.v), hn::Zero(integers)))};
}
/// Largest power of two not above |x|; 0 for x = 0 and for denormal numbers.
HWY_INLINE Pack<double> power_of_two_below(Pack<double> x) {
  const hn::RebindToUnsigned<Tag<double>> integers;
  return hn::And(x.v, hn::BitCast(Tag<double>(), hn::Set(integers, 0x7FF0000000000000ull)));
}
HWY_INLINE Pack<float> power_of_two_below(Pack<float> x) {
  const hn::RebindToUnsigned<Tag<float>> integers;
  return hn::And(x.v, hn::BitCast(Tag<float>(), hn::Set(integers, 0x7F800000u)));
}

template <class T>
struct Pack3 {
  Pack<T> x, y, z;
};
template <class T>
HWY_INLINE Pack3<T> operator+(const Pack3<T>& a, const Pack3<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
HWY_INLINE Pack3<T> operator-(const Pack3<T>& a, const Pack3<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
HWY_INLINE Pack3<T> operator*(Pack<T> s, const Pack3<T>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class T>
HWY_INLINE Pack<T> dot(const Pack3<T>& a, const Pack3<T>& b) {
  return mul_add(a.z, b.z, mul_add(a.y, b.y, a.x * b.x));
}
template <class T>
HWY_INLINE Pack3<T> cross(const Pack3<T>& a, const Pack3<T>& b) {
  return {mul_sub(a.y, b.z, a.z * b.y), mul_sub(a.z, b.x, a.x * b.z), mul_sub(a.x, b.y, a.y * b.x)};
}
/// b + s a
template <class T>
HWY_INLINE Pack3<T> mul_add(Pack<T> s, const Pack3<T>& a, const Pack3<T>& b) {
  return {mul_add(s, a.x, b.x), mul_add(s, a.y, b.y), mul_add(s, a.z, b.z)};
}
/// b - s a
template <class T>
HWY_INLINE Pack3<T> neg_mul_add(Pack<T> s, const Pack3<T>& a, const Pack3<T>& b) {
  return {neg_mul_add(s, a.x, b.x), neg_mul_add(s, a.y, b.y), neg_mul_add(s, a.z, b.z)};
}
template <class T>
HWY_INLINE Pack3<T> select(Mask<T> m, const Pack3<T>& yes, const Pack3<T>& no) {
  return {select(m, yes.x, no.x), select(m, yes.y, no.y), select(m, yes.z, no.z)};
}
template <class T>
HWY_INLINE Pack<T> largest_component(const Pack3<T>& a) {
  return max(max(abs(a.x), abs(a.y)), abs(a.z));
}

/// One triangle per lane.
template <class T>
struct TrianglePack {
  Pack3<T> p[3];
};

// NOLINTNEXTLINE(google-readability-namespace-comments)
}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
