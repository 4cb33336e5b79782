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

/// Four numbers of rows of bodies, one row in each lane: column[j] has the number `first` + j of each.
/// A gather costs as much as four of these shuffles, or more.
HWY_INLINE void load_quarters(const BallRow* rows, const std::int64_t* index, std::size_t first, Lane* column) {
  static_assert(sizeof(BallRow) == 16 * sizeof(double));
  const auto at = [=](std::size_t lane) { return &rows[index[lane]].x.x + first; };
#if HWY_TARGET == HWY_SCALAR
  for (std::size_t j = 0; j < 4; ++j) column[j] = Lane(at(0)[j]);
#elif HWY_TARGET <= HWY_AVX3
  // a half of 256 bits is loaded into its place, which takes no shuffle: two stages are left
  const auto halves = [&](std::size_t lane) {
    return _mm512_mask_broadcast_f64x4(_mm512_castpd256_pd512(_mm256_load_pd(at(lane))), 0xf0, _mm256_load_pd(at(lane + 2)));
  };
  const __m512d a = halves(0), b = halves(1), c = halves(4), d = halves(5);
  const __m512d lower0 = _mm512_unpacklo_pd(a, b), lower1 = _mm512_unpacklo_pd(c, d), upper0 = _mm512_unpackhi_pd(a, b),
                upper1 = _mm512_unpackhi_pd(c, d);
  column[0].v = hn::Vec<Tag<double>>{_mm512_shuffle_f64x2(lower0, lower1, 0x88)};
  column[1].v = hn::Vec<Tag<double>>{_mm512_shuffle_f64x2(upper0, upper1, 0x88)};
  column[2].v = hn::Vec<Tag<double>>{_mm512_shuffle_f64x2(lower0, lower1, 0xdd)};
  column[3].v = hn::Vec<Tag<double>>{_mm512_shuffle_f64x2(upper0, upper1, 0xdd)};
#else
  const Tag<double> d;
  if constexpr (kLanes == 2) {
    for (std::size_t j = 0; j < 4; j += 2) {
      const auto a = hn::Load(d, at(0) + j), b = hn::Load(d, at(1) + j);
      column[j].v = hn::InterleaveLower(d, a, b);
      column[j + 1].v = hn::InterleaveUpper(d, a, b);
    }
  } else {
    const auto a = hn::Load(d, at(0)), b = hn::Load(d, at(1)), e = hn::Load(d, at(2)), f = hn::Load(d, at(3));
    const auto lower0 = hn::InterleaveLower(d, a, b), lower1 = hn::InterleaveLower(d, e, f), upper0 = hn::InterleaveUpper(d, a, b),
               upper1 = hn::InterleaveUpper(d, e, f);
    column[0].v = hn::ConcatLowerLower(d, lower1, lower0);
    column[1].v = hn::ConcatLowerLower(d, upper1, upper0);
    column[2].v = hn::ConcatUpperUpper(d, lower1, lower0);
    column[3].v = hn::ConcatUpperUpper(d, upper1, upper0);
  }
#endif
}

/// A body in each lane.
struct LaneBody {
  Lane3 x, v, w;
  LaneQuat q;
  Lane radius, inverse_mass, equivalent_radius;
};

/// in   kRows   from scene.rows, else from the columns
template <bool kRows>
HWY_INLINE LaneBody load_body(const BallScene& scene, const std::int64_t* index) {
  if constexpr (kRows) {
    Lane x[4], v[4], w[4], q[4];
    load_quarters(scene.rows, index, 0, x);
    load_quarters(scene.rows, index, 4, v);
    load_quarters(scene.rows, index, 8, w);
    load_quarters(scene.rows, index, 12, q);
    return {{x[0], x[1], x[2]}, {v[0], v[1], v[2]}, {w[0], w[1], w[2]}, {q[0], q[1], q[2], q[3]}, x[3], v[3], w[3]};
  } else {
    const ParticleSet& p = scene.p;
    const Rows row(index);
    return {row.of(p.x), row.of(p.v), row.of(p.w), row.of(p.q), row.of(p.ball_radius), row.of(p.inverse_mass), row.of(p.equivalent_radius)};
  }
}

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
