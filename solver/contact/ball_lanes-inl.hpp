// Vectors, quaternions and matrices of core/geometry/vec3.hpp with a pair in each lane: the same operations in the same order, none of
// them fused, so that each lane has the bits of the plain code. Included once for every instruction set by ball_forces.cpp.
#if defined(SCREE_SOLVER_CONTACT_BALL_LANES_INL_HPP_) == defined(HWY_TARGET_TOGGLE)
#ifdef SCREE_SOLVER_CONTACT_BALL_LANES_INL_HPP_
#undef SCREE_SOLVER_CONTACT_BALL_LANES_INL_HPP_
#else
#define SCREE_SOLVER_CONTACT_BALL_LANES_INL_HPP_
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/distance/simd-inl.hpp"
#include "core/geometry/vec3.hpp"
#include "solver/contact/ball_forces.hpp"

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {

using Lane = Pack<double>;
/// At most 8, as ball_forces.hpp has places for: vectors of a length that is known as the program is built.
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
HWY_INLINE Lane3 rotate_inverse(const LaneQuat& q, const Lane3& v) {
  const Lane3 u{-q.x, -q.y, -q.z}, t = Lane(2.0) * cross(u, v);
  return v + q.w * t + cross(u, t);
}

/// matrix_of(q).
class LaneMatrix {
 public:
  HWY_INLINE explicit LaneMatrix(const LaneQuat& q) {
    const Lane xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z, xy = q.x * q.y, xz = q.x * q.z, yz = q.y * q.z, wx = q.w * q.x,
               wy = q.w * q.y, wz = q.w * q.z, one(1.0), two(2.0);
    rows_[0] = {one - two * (yy + zz), two * (xy - wz), two * (xz + wy)};
    rows_[1] = {two * (xy + wz), one - two * (xx + zz), two * (yz - wx)};
    rows_[2] = {two * (xz - wy), two * (yz + wx), one - two * (xx + yy)};
  }
  HWY_INLINE Lane3 times(const Lane3& v) const { return {dot(rows_[0], v), dot(rows_[1], v), dot(rows_[2], v)}; }
  HWY_INLINE Lane3 transpose_times(const Lane3& v) const { return v.x * rows_[0] + v.y * rows_[1] + v.z * rows_[2]; }

 private:
  Lane3 rows_[3];
};

/// Periodicity::nearest; a period of 0 is that of an axis without end.
HWY_INLINE Lane nearest(double period, Lane d) {
  const Lane whole(period), half(0.5 * period), other(-0.5 * period);
  return select(d > half, d - whole, select(d < other, d + whole, d));
}
HWY_INLINE Lane3 nearest(const Vec3& period, const Lane3& d) {
  return {nearest(period.x, d.x), nearest(period.y, d.y), nearest(period.z, d.z)};
}

/// Rows of the particle set, one in each lane.
class Rows {
 public:
  HWY_INLINE explicit Rows(const std::int64_t* rows)
      : row_(hn::LoadU(Integers(), rows)), three_(hn::Add(row_, hn::Add(row_, row_))), four_(hn::ShiftLeft<2>(row_)) {}
  HWY_INLINE Lane of(const std::vector<double>& column) const { return gather(column.data(), row_); }
  HWY_INLINE Lane3 of(const std::vector<Vec3>& column) const {
    const double* first = &column.data()->x;
    return {gather(first, three_), gather(first + 1, three_), gather(first + 2, three_)};
  }
  HWY_INLINE LaneQuat of(const std::vector<Quat>& column) const {
    const double* first = &column.data()->w;
    return {gather(first, four_), gather(first + 1, four_), gather(first + 2, four_), gather(first + 3, four_)};
  }

 private:
  using Integers = hn::RebindToSigned<Tag<double>>;
  static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Quat) == 4 * sizeof(double));
  static HWY_INLINE Lane gather(const double* from, hn::Vec<Integers> index) { return hn::GatherIndex(Tag<double>(), from, index); }
  hn::Vec<Integers> row_, three_, four_;
};

/// Rows of walls, one in each lane.
class WallRows {
 public:
  HWY_INLINE WallRows(const std::vector<BallWall>& walls, const std::int64_t* rows)
      : walls_(walls.data()), first_(hn::ShiftLeft<5>(hn::LoadU(hn::RebindToSigned<Tag<double>>(), rows))) {}
  HWY_INLINE Lane of(double BallWall::*number) const { return gather(&(walls_->*number)); }
  HWY_INLINE Lane3 of(Vec3 BallWall::*vector) const {
    const double* first = &(walls_->*vector).x;
    return {gather(first), gather(first + 1), gather(first + 2)};
  }
  HWY_INLINE LaneQuat of(Quat BallWall::*turn) const {
    const double* first = &(walls_->*turn).w;
    return {gather(first), gather(first + 1), gather(first + 2), gather(first + 3)};
  }

 private:
  static_assert(sizeof(BallWall) == 32 * sizeof(double));
  HWY_INLINE Lane gather(const double* from) const { return hn::GatherIndex(Tag<double>(), from, first_); }
  const BallWall* walls_;
  hn::Vec<hn::RebindToSigned<Tag<double>>> first_;
};

/// Rows of BallLaws, one in each lane.
class LawRows {
 public:
  HWY_INLINE LawRows(const BallLaw* laws, const std::int64_t* rows)
      : laws_(laws), first_(hn::ShiftLeft<3>(hn::LoadU(hn::RebindToSigned<Tag<double>>(), rows))) {}
  HWY_INLINE Lane at(double BallLaw::*number) const { return hn::GatherIndex(Tag<double>(), &(laws_->*number), first_); }

 private:
  static_assert(sizeof(BallLaw) == 8 * sizeof(double));
  const BallLaw* laws_;
  hn::Vec<hn::RebindToSigned<Tag<double>>> first_;
};

/// Four numbers of each pair from `k` on: three of a vector and one.
template <class Fours>
HWY_INLINE std::pair<Lane3, Lane> load_fours(const Fours& from, std::size_t k) {
  Lane3 v;
  Lane last;
  hn::LoadInterleaved4(Tag<double>(), from.data() + 4 * k, v.x.v, v.y.v, v.z.v, last.v);
  return {v, last};
}
template <class Fours>
HWY_INLINE void store_fours(const Lane3& v, Lane last, std::size_t k, Fours& to) {
  hn::StoreInterleaved4(v.x.v, v.y.v, v.z.v, last.v, Tag<double>(), to.data() + 4 * k);
}

// NOLINTNEXTLINE(google-readability-namespace-comments)
}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
