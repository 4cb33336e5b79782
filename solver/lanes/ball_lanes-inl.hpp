// What the lanes of ball_forces.cpp and mesh_forces.cpp are filled from: rows of bodies, walls and laws. Included by them once for every
// instruction set.
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

#include "solver/bodies/lanes-inl.hpp"
#include "solver/lanes/ball_rows.hpp"

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {

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

/// The nearest image of B.
HWY_INLINE Lane3 image_of(const Periodicity& periodicity, const Lane3& xa, const Lane3& xb) {
  return periodicity.any() ? xa + nearest(periodicity.period(), xb - xa) : xb;
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

/// Rows of LaneLaws, and of what goes with it, one in each lane. Most scenes have one row, which all lanes share.
template <class Law>
class LawRows {
 public:
  HWY_INLINE LawRows(const std::vector<Law>& laws, const std::int64_t* rows)
      : laws_(laws.data()), is_one_(laws.size() == 1), first_(hn::ShiftLeft<kShift>(hn::LoadU(hn::RebindToSigned<Tag<double>>(), rows))) {}
  HWY_INLINE Lane at(double Law::*number) const {
    return is_one_ ? Lane(laws_->*number) : Lane(hn::GatherIndex(Tag<double>(), &(laws_->*number), first_));
  }

 private:
  static constexpr int kShift = sizeof(Law) == 8 * sizeof(double) ? 3 : 1;
  static_assert(sizeof(Law) == (std::size_t{1} << kShift) * sizeof(double));
  const Law* laws_;
  bool is_one_;
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
