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
#include <cstring>
#include <utility>
#include <vector>

#include "solver/bodies/lanes-inl.hpp"
#include "solver/lanes/ball_rows.hpp"
#include "solver/lanes/columns-inl.hpp"

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
  HWY_INLINE const Lane3& row(std::size_t i) const { return rows_[i]; }

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

HWY_INLINE Lane rounded(Lane x) { return {hn::Round(x.v)}; }
/// The same of a cell that is sheared, Periodicity::nearest_in_sheared.
HWY_INLINE Lane3 nearest_in_sheared(const Periodicity& periodicity, const Lane3& d) {
  const Vec3 &period = periodicity.period(), &shear = periodicity.shear();
  const Lane zero(0.0), one(1.0), px(period.x), py(period.y), pz(period.z), yz(shear.x), xz(shear.y), xy(shear.z);
  const Lane nz = select(d.z > Lane(0.5 * period.z), one, select(d.z < Lane(-0.5 * period.z), -one, zero));
  const Lane ny = rounded((d.y - nz * yz) / py);
  const Lane nx = rounded((d.x - (nz * xz + ny * xy)) / px);
  return d - Lane3{nz * xz + ny * xy + nx * px, nz * yz + ny * py, nz * pz};
}

/// The nearest image of B.
HWY_INLINE Lane3 image_of(const Periodicity& periodicity, const Lane3& xa, const Lane3& xb) {
  if (!periodicity.any()) return xb;
  if (periodicity.is_sheared()) return xa + nearest_in_sheared(periodicity, xb - xa);
  return xa + nearest(periodicity.period(), xb - xa);
}

/// How fast B moves with a cell that deforms, against A: Cell::velocity_along() in a step.
HWY_INLINE Lane3 velocity_along(const Cell& cell, const Lane3& branch) {
  const Vec3 &of = cell.rate_of_step().diagonal, &above = cell.rate_of_step().above;
  return {Lane(of.x) * branch.x + Lane(above.z) * branch.y + Lane(above.y) * branch.z, Lane(of.y) * branch.y + Lane(above.x) * branch.z,
          Lane(of.z) * branch.z};
}

/// Rows of the particle set, one in each lane.
class Rows {
 public:
  HWY_INLINE explicit Rows(const std::int32_t* rows)
      : Rows(hn::PromoteTo(Integers(), hn::LoadU(hn::Rebind<std::int32_t, Integers>(), rows))) {}
  HWY_INLINE explicit Rows(const std::int64_t* rows) : Rows(hn::LoadU(Integers(), rows)) {}
  HWY_INLINE Lane of(const std::vector<double>& column) const {
    return {hn::GatherIndex(Tag<double>(), column.data(), hn::Load(Integers(), index_))};
  }
  HWY_INLINE Lane3 of(const std::vector<Vec3>& column) const {
    return load_vectors([&](std::size_t lane) { return &column.data()[index_[lane]].x; });
  }
  HWY_INLINE LaneQuat of(const std::vector<Quat>& column) const {
    Lane q[4];
    load_columns([&](std::size_t lane) { return &column.data()[index_[lane]].w; }, q);
    return {q[0], q[1], q[2], q[3]};
  }

 private:
  using Integers = hn::RebindToSigned<Tag<double>>;
  HWY_INLINE explicit Rows(hn::Vec<Integers> rows) { hn::Store(rows, Integers(), index_); }
  alignas(64) std::int64_t index_[kLanes];
};

/// Four numbers of A's rows less those of B's, their sums, or A's alone, a pair in each lane: column[j] has the number `first` + j.
template <Of kOf>
HWY_INLINE void load_quarters(const BallRow* rows, const std::int32_t* a, const std::int32_t* b, std::size_t first, Lane* column) {
  static_assert(sizeof(BallRow) == 12 * sizeof(double));
  load_columns<kOf>([=](std::size_t lane) { return &rows[a[lane]].x.v.x + first; },
                    [=](std::size_t lane) { return &rows[b[lane]].x.v.x + first; }, column);
}

/// One wall in all lanes.
class OneWall {
 public:
  HWY_INLINE explicit OneWall(const BallWall& wall) : wall_(wall) {}
  HWY_INLINE Lane of(double BallWall::*number) const { return Lane(wall_.*number); }
  HWY_INLINE Lane3 of(Vec3 BallWall::*vector) const {
    const Vec3& v = wall_.*vector;
    return {Lane(v.x), Lane(v.y), Lane(v.z)};
  }
  HWY_INLINE LaneQuat of(Quat BallWall::*turn) const {
    const Quat& q = wall_.*turn;
    return {Lane(q.w), Lane(q.x), Lane(q.y), Lane(q.z)};
  }

 private:
  const BallWall& wall_;
};

/// Rows of walls, one in each lane.
class WallRows {
 public:
  HWY_INLINE WallRows(const std::vector<BallWall>& walls, const std::int32_t* rows)
      : walls_(walls.data()), first_(hn::ShiftLeft<5>(hn::PromoteTo(Integers(), hn::LoadU(hn::Rebind<std::int32_t, Integers>(), rows)))) {}
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
  using Integers = hn::RebindToSigned<Tag<double>>;
  static_assert(sizeof(BallWall) == 32 * sizeof(double));
  HWY_INLINE Lane gather(const double* from) const { return hn::GatherIndex(Tag<double>(), from, first_); }
  const BallWall* walls_;
  hn::Vec<Integers> first_;
};

/// Rows of LaneLaws, and of what goes with it, one in each lane. Most scenes have one row, which all lanes share.
template <class Law>
class LawRows {
 public:
  HWY_INLINE LawRows(const std::vector<Law>& laws, const std::int64_t* rows) : laws_(laws.data()), rows_(rows), is_one_(laws.size() == 1) {}
  HWY_INLINE Lane at(double Law::*number) const {
    if (is_one_) return Lane(laws_->*number);
    const auto first = hn::ShiftLeft<kShift>(hn::LoadU(hn::RebindToSigned<Tag<double>>(), rows_));  // not read where all share one
    return {hn::GatherIndex(Tag<double>(), &(laws_->*number), first)};
  }

 private:
  static constexpr int kShift = sizeof(Law) == 8 * sizeof(double) ? 3 : 1;
  static_assert(sizeof(Law) == (std::size_t{1} << kShift) * sizeof(double));
  const Law* laws_;
  const std::int64_t* rows_;
  bool is_one_;
};

/// A vector and a number of each lane as rows of `stride` numbers.
HWY_INLINE void store_rows(const Lane3& v, Lane last, double* to, std::size_t stride) {
  store_columns([=](std::size_t lane) { return to + lane * stride; }, v, last);
}

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
