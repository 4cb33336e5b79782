// The kernel of ball_motion.hpp, compiled once for every instruction set (Highway's foreach_target), for the baseline, never with
// -march=native. Sums go four numbers of one body at a time, motion goes one body in each lane: between them the sums of as many bodies as
// there are lanes lie in rows on the stack.
#include "solver/lanes/ball_motion.hpp"

#include <algorithm>
#include <array>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solver/lanes/ball_motion.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "solver/bodies/motion_lanes-inl.hpp"
#include "solver/lanes/ball_lanes-inl.hpp"
#include "solver/lanes/ball_sums-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {

/// What acts on a body in a step, and what of it is dissipative: four times three numbers and one that is not used.
struct alignas(128) OnBody {
  double number[16];
};
enum : std::size_t { kForce = 0, kTorque = 4, kLost = 8, kLostTorque = 12 };

/// Three numbers of each of kLanes rows.
HWY_INLINE Lane3 load_rows(const double* first, std::size_t stride) {
  Lane column[4];
  load_columns([=](std::size_t lane) { return first + lane * stride; }, column);
  return {column[0], column[1], column[2]};
}
HWY_INLINE Lane3 load_rows(const OnBody* on, std::size_t first) { return load_rows(on->number + first, sizeof(OnBody) / sizeof(double)); }
HWY_INLINE Lane3 spins_of(const BallRow* rows) { return load_rows(&rows->w.v.x, sizeof(BallRow) / sizeof(double)); }

// kLanes balls of a group from place `at` on
HWY_INLINE Lane3 load_three(const std::array<BallGroup::Eight, 3>& from, std::size_t at) {
  return {Lane::load(&from[0][at]), Lane::load(&from[1][at]), Lane::load(&from[2][at])};
}
HWY_INLINE void store_three(const Lane3& v, std::size_t at, std::array<BallGroup::Eight, 3>& to) {
  v.x.store(&to[0][at]);
  v.y.store(&to[1][at]);
  v.z.store(&to[2][at]);
}
HWY_INLINE LaneQuat load_four(const std::array<BallGroup::Eight, 4>& from, std::size_t at) {
  return {Lane::load(&from[0][at]), Lane::load(&from[1][at]), Lane::load(&from[2][at]), Lane::load(&from[3][at])};
}
HWY_INLINE void store_four(const LaneQuat& q, std::size_t at, std::array<BallGroup::Eight, 4>& to) {
  q.w.store(&to[0][at]);
  q.x.store(&to[1][at]);
  q.y.store(&to[2][at]);
  q.z.store(&to[3][at]);
}

/// Sums of kLanes bodies from `begin` on; of bodies that are none, nothing. Returns whether some were in columns.
template <bool kRolls, bool kAsks>
HWY_INLINE bool sum_some(const BallMotion& motion, const BallGroup& group, const Numbers& gravity, std::size_t begin, OnBody* on) {
  const ParticleSet& p = motion.p;
  bool from_columns = false;
  for (std::size_t k = 0; k < kLanes; ++k) {
    const std::size_t i = begin + k, at = i % BallGroup::kBalls;
    if (HWY_UNLIKELY(i >= p.owned)) {
      on[k] = {};
      continue;
    }
    if (kAsks && i + kBodiesAhead < p.owned) ask_for_slots(motion.sums, i + kBodiesAhead);
    if (HWY_UNLIKELY(motion.summed[i] != 0)) {
      const Vec3 &f = p.force[i], &t = p.torque[i], &lost = p.dissipative_force[i], &lost_t = p.dissipative_torque[i];
      on[k] = {{f.x, f.y, f.z, 0, t.x, t.y, t.z, 0, lost.x, lost.y, lost.z, 0, lost_t.x, lost_t.y, lost_t.z, 0}};
      from_columns = true;
      continue;
    }
    OnBall sum = sum_on_ball<kRolls>(motion.sums, i, group.radius[at]);
    sum.force.add_scaled_vector(gravity, group.mass[at]);
    double* const row = on[k].number;
    sum.force.store(row + kForce);
    sum.torque.store(row + kTorque);
    sum.lost.store(row + kLost);
    sum.torque.store(row + kLostTorque);
  }
  return from_columns;
}

/// A periodic cell, and which bodies may have left it.
class CellWalls {
 public:
  HWY_INLINE explicit CellWalls(const Periodicity& periodicity) : any_(periodicity.any()) {
    for (int k = 0; k < 3; ++k) {
      const bool is_periodic = periodicity.is_periodic(k);
      const double lower = periodicity.lower()[k], infinity = std::numeric_limits<double>::infinity();
      lower_[k] = is_periodic ? lower : -infinity;
      upper_[k] = is_periodic ? kInside * periodicity.period()[k] : infinity;
      offset_[k] = is_periodic ? lower : 0;
    }
  }
  HWY_INLINE bool any() const { return any_; }
  /// False only where Periodicity::wrap() would not move a body.
  HWY_INLINE bool may_be_left(const Lane3& x) const { return is_out(x.x, 0) || is_out(x.y, 1) || is_out(x.z, 2); }

 private:
  static constexpr double kInside = 1 - 1e-12;  // far above the rounding of the quotient there
  HWY_INLINE bool is_out(Lane x, int k) const {
    return scree::HWY_NAMESPACE::any((x < Lane(lower_[k])) | (x - Lane(offset_[k]) > Lane(upper_[k])));
  }
  bool any_;
  double lower_[3], upper_[3], offset_[3];
};

/// Bodies from `begin` on that have left the cell come in on its other side.
HWY_NOINLINE void wrap_some(ParticleSet& p, std::size_t begin, Lane3& x) {
  alignas(64) double place[3][kLanes];
  x.x.store(place[0]);
  x.y.store(place[1]);
  x.z.store(place[2]);
  for (std::size_t k = 0; k < kLanes && begin + k < p.owned; ++k) {
    Vec3 at{place[0][k], place[1][k], place[2][k]};
    p.x_listed[begin + k] += p.cell.periodicity().wrap(at, p.image[begin + k]);
    for (int axis = 0; axis < 3; ++axis) place[axis][k] = at[axis];
  }
  x = {Lane::load(place[0]), Lane::load(place[1]), Lane::load(place[2])};
}

/// What all vectors of bodies share.
struct StepInLanes {
  Lane step, half_step, time;
  CellWalls cell;
};

/// kLanes bodies from `begin` on, from the forces on them to their next places.   in   kFree   all of them move and turn
/// out   v, w, x   of the next step
template <bool kFree>
HWY_INLINE void move_some(const BallMotion& motion, const StepInLanes& s, BallGroup& group, const OnBody* on, bool from_columns,
                          std::size_t begin, Lane inverse_mass, Lane rate_of_w, Lane3& x, Lane3& v, Lane3& w) {
  const Lane zero(0.0);
  const std::size_t at = begin % BallGroup::kBalls;
  const auto moves = inverse_mass > zero, turns = rate_of_w > zero;
  // what a body that does not move, or turn, keeps
  const auto where_moves = [&](const auto& yes, const auto& no) { return kFree ? yes : select(moves, yes, no); };
  const auto where_turns = [&](const auto& yes, const auto& no) { return kFree ? yes : select(turns, yes, no); };
  const Lane3 force = load_rows(on, kForce), torque = load_rows(on, kTorque);

  // the second kick of the step, kick_row() of motion.cpp
  const Lane3 v0 = load_three(group.v, at), L0 = load_three(group.L, at);
  const Lane3 push = (s.half_step * inverse_mass) * force, turning = s.half_step * torque;
  const Lane3 v1 = where_moves(v0 + push, v0), L1 = L0 + turning;
  const Lane3 w0 = kFree ? Lane3{zero, zero, zero} : spins_of(motion.rows + begin), w1 = where_turns(rate_of_w * L1, w0);

  // add_dissipation_of_rows()
  const Lane3 lost_torque = HWY_UNLIKELY(from_columns) ? load_rows(on, kLostTorque) : torque;
  const Lane power = dot(load_rows(on, kLost), v1) + dot(lost_torque, w1);
  (Lane::load(&group.dissipated[at]) + where_moves(s.time * power, zero)).store(&group.dissipated[at]);

  // the first kick of the next step and its drift, kick_and_drift_row()
  const Lane3 v2 = v1 + push, way = s.step * v2, x0 = load_three(group.x, at), left0 = load_three(group.x_remainder, at);
  x = x0;
  Lane3 left = left0;
  advance(x.x, left.x, way.x);
  advance(x.y, left.y, way.y);
  advance(x.z, left.z, way.z);
  v = where_moves(v2, v1);
  x = where_moves(x, x0);
  if (HWY_UNLIKELY(s.cell.any()) && HWY_UNLIKELY(s.cell.may_be_left(x))) wrap_some(motion.p, begin, x);
  store_three(v, at, group.v);
  store_three(x, at, group.x);
  store_three(where_moves(left, left0), at, group.x_remainder);

  const Lane3 L2 = L1 + turning, spin = rate_of_w * L2;
  w = where_turns(spin, w1);
  const Lane aa = (s.half_step * s.half_step) * dot(spin, spin);
  const LaneQuat q0 = load_four(group.q, at), rest0 = load_four(group.q_remainder, at);
  LaneQuat q = q0, rest = rest0;
  turn_about(spin, aa, s.half_step, q, rest);
  store_three(where_turns(L2, L0), at, group.L);
  if (const auto rotates = turns & (aa > zero); !kFree || HWY_UNLIKELY(any(!rotates))) {
    q = select(rotates, q, q0);
    rest = select(rotates, rest, rest0);
  }
  store_four(q, at, group.q);
  store_four(rest, at, group.q_remainder);
}

template <bool kRolls, bool kAsks>
BallsMoved move_groups(const BallMotion& motion, std::size_t begin, std::size_t end) {
  const Lane zero(0.0), share((1 - 1e-12) * (motion.share / motion.dt));  // some rounding on the safe side
  const StepInLanes step{Lane(motion.dt), Lane(0.5 * motion.dt), Lane(-motion.dt), CellWalls(motion.p.cell.periodicity())};
  Numbers gravity;
  alignas(32) const double of_gravity[4] = {motion.gravity.x, motion.gravity.y, motion.gravity.z, 0};
  for (std::size_t j = 0; j < 4 / kWidth; ++j) gravity.part[j] = hn::Load(Four(), of_gravity + kWidth * j);
  Lane fastest = zero;
  BallsMoved moved;
  alignas(128) OnBody on[kLanes];
  for (std::size_t i = begin * BallGroup::kBalls; i < end * BallGroup::kBalls; i += kLanes) {
    const std::size_t at = i % BallGroup::kBalls;
    BallGroup& group = motion.groups[i / BallGroup::kBalls];
    const bool from_columns = sum_some<kRolls, kAsks>(motion, group, gravity, i, on);
    const Lane inverse_mass = Lane::load(&group.inverse_mass[at]), rate_of_w = Lane::load(&group.inverse_inertia[at]);
    Lane3 x, v, w;
    if (HWY_LIKELY(!any(!((inverse_mass > zero) & (rate_of_w > zero)))))
      move_some<true>(motion, step, group, on, from_columns, i, inverse_mass, rate_of_w, x, v, w);
    else
      move_some<false>(motion, step, group, on, from_columns, i, inverse_mass, rate_of_w, x, v, w);

    double* const rows = &motion.rows[i].x.v.x;
    constexpr std::size_t kStride = sizeof(BallRow) / sizeof(double);
    const Lane radius = Lane::load(&group.radius[at]), most = share * radius;
    store_rows(x, zero, rows, kStride);
    store_rows(v, zero, rows + 4, kStride);
    store_rows(w, zero, rows + 8, kStride);
    const Lane squared = dot(v, v);
    fastest = Lane{select(squared > fastest, squared, fastest)};
    if (any(!(squared <= most * most))) moved.go_far = true;  // or is no number
  }
  alignas(64) double speeds[kLanes];
  fastest.store(speeds);
  moved.squared_speed = *std::max_element(speeds, speeds + kLanes);
  return moved;
}

HWY_NOINLINE BallsMoved move_range(const BallMotion& motion, std::size_t begin, std::size_t end) {
  const bool asks = asks_for_slots(motion.sums);
  if (motion.sums.moments != nullptr)
    return asks ? move_groups<true, true>(motion, begin, end) : move_groups<true, false>(motion, begin, end);
  return asks ? move_groups<false, true>(motion, begin, end) : move_groups<false, false>(motion, begin, end);
}

}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scree {
namespace {

HWY_EXPORT(move_range);

void put(const Vec3& from, std::size_t n, std::array<BallGroup::Eight, 3>& to) {
  to[0][n] = from.x;
  to[1][n] = from.y;
  to[2][n] = from.z;
}
void put(const Quat& from, std::size_t n, std::array<BallGroup::Eight, 4>& to) {
  to[0][n] = from.w;
  to[1][n] = from.x;
  to[2][n] = from.y;
  to[3][n] = from.z;
}
Vec3 vector_of(const std::array<BallGroup::Eight, 3>& from, std::size_t n) { return {from[0][n], from[1][n], from[2][n]}; }
Quat quaternion_of(const std::array<BallGroup::Eight, 4>& from, std::size_t n) { return {from[0][n], from[1][n], from[2][n], from[3][n]}; }

}  // namespace

void group_balls(const ParticleSet& p, std::size_t begin, std::size_t end, BallGroup* groups, BallRow* rows) {
  for (std::size_t g = begin; g < end; ++g) {
    BallGroup& group = groups[g];
    for (std::size_t n = 0; n < BallGroup::kBalls; ++n) {
      const std::size_t i = g * BallGroup::kBalls + n;
      const bool is_one = i < p.owned;
      put(is_one ? p.x[i] : Vec3{}, n, group.x);
      put(is_one ? p.x_remainder[i] : Vec3{}, n, group.x_remainder);
      put(is_one ? p.v[i] : Vec3{}, n, group.v);
      put(is_one ? p.L[i] : Vec3{}, n, group.L);
      put(is_one ? p.q[i] : Quat{}, n, group.q);
      put(is_one ? p.q_remainder[i] : Quat{0, 0, 0, 0}, n, group.q_remainder);
      group.dissipated[n] = is_one ? p.dissipated[i] : 0;
      group.mass[n] = is_one ? p.mass[i] : 1;
      group.inverse_mass[n] = is_one ? p.inverse_mass[i] : 0;
      group.inverse_inertia[n] = is_one ? p.inverse_inertia[i].x : 0;
      group.radius[n] = is_one ? p.ball_radius[i] : 1;
      if (!is_one) rows[i] = {};
    }
  }
  const std::size_t first = begin * BallGroup::kBalls, last = std::min(end * BallGroup::kBalls, p.owned);
  if (first < last) collect_ball_rows(p, first, last, rows);
}

void ungroup_balls(const BallGroup* groups, const BallRow* rows, std::size_t begin, std::size_t end, ParticleSet& p) {
  for (std::size_t i = begin * BallGroup::kBalls; i < std::min(end * BallGroup::kBalls, p.owned); ++i) {
    const BallGroup& group = groups[i / BallGroup::kBalls];
    const std::size_t n = i % BallGroup::kBalls;
    p.x[i] = vector_of(group.x, n);
    p.x_remainder[i] = vector_of(group.x_remainder, n);
    p.v[i] = vector_of(group.v, n);
    p.L[i] = vector_of(group.L, n);
    p.w[i] = rows[i].w.v;
    p.q[i] = quaternion_of(group.q, n);
    p.q_remainder[i] = quaternion_of(group.q_remainder, n);
    p.dissipated[i] = group.dissipated[n];
  }
}

BallsMoved move_balls(const BallMotion& motion, std::size_t begin, std::size_t end) {
  return HWY_DYNAMIC_DISPATCH(move_range)(motion, begin, end);
}

}  // namespace scree
#endif
