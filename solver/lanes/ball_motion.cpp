// The kernel of ball_motion.hpp, compiled once for every instruction set (Highway's foreach_target), for the baseline, never with
// -march=native. Sums go four numbers of one body at a time, motion goes one body in each lane: between them the sums of as many bodies as
// there are lanes lie in rows on the stack. Rows that do not fill a vector go by the passes that do one thing each.
#include "solver/lanes/ball_motion.hpp"

#include <algorithm>
#include <array>

#include "solver/bodies/body_passes.hpp"
#include "solver/bodies/motion.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solver/lanes/ball_motion.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "solver/bodies/motion_lanes-inl.hpp"
#include "solver/lanes/ball_lanes-inl.hpp"
#include "solver/lanes/ball_sums-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {

/// What acts on a body in a step, and what of it is dissipative, as four rows: those of BallRow, so that they are loaded as these are.
using OnBody = BallRow;
enum : std::size_t { kForce = 0, kTorque = 4, kLost = 8, kLostTorque = 12 };

HWY_INLINE Lane3 load_rows(const OnBody* on, std::size_t first) {
  alignas(64) static constexpr std::array<std::int32_t, 8> kOrder{0, 1, 2, 3, 4, 5, 6, 7};
  Lane column[4];
  load_quarters<Of::one>(on, kOrder.data(), kOrder.data(), first, column);
  return {column[0], column[1], column[2]};
}

template <bool kRolls, bool kAsks>
HWY_INLINE void sum_some(const BallMotion& motion, const Numbers& gravity, std::size_t begin, std::size_t end, const ParticleSet& p,
                         OnBody* on) {
  for (std::size_t k = 0; k < kLanes; ++k) {
    const std::size_t i = begin + k;
    if (kAsks && i + kBodiesAhead < end) ask_for_slots(motion.sums, i + kBodiesAhead);
    if (HWY_UNLIKELY(motion.summed[i] != 0)) {
      on[k] = {{p.force[i]}, {p.torque[i]}, {p.dissipative_force[i]}, {p.dissipative_torque[i]}};
      continue;
    }
    OnBall sum = sum_on_ball<kRolls>(motion.sums, i, p.ball_radius[i]);
    sum.force.add_scaled_vector(gravity, p.mass[i]);
    double* const row = &on[k].x.v.x;
    sum.force.store(row + kForce);
    sum.torque.store(row + kTorque);
    sum.lost.store(row + kLost);
    sum.torque.store(row + kLostTorque);
  }
}

template <bool kRolls, bool kAsks>
double move_rows(const BallMotion& motion, std::size_t begin, std::size_t end, ParticleSet& p) {
  const Lane zero(0.0), step(motion.dt), half_step(0.5 * motion.dt), time(-motion.dt);
  Numbers gravity;
  alignas(32) const double of_gravity[4] = {motion.gravity.x, motion.gravity.y, motion.gravity.z, 0};
  for (std::size_t j = 0; j < 4 / kWidth; ++j) gravity.part[j] = hn::Load(Four(), of_gravity + kWidth * j);
  Lane fastest = zero;
  alignas(128) OnBody on[kLanes];
  for (std::size_t i = begin; i < end; i += kLanes) {
    sum_some<kRolls, kAsks>(motion, gravity, i, end, p, on);
    const Lane inverse_mass = Lane::load(&p.inverse_mass[i]), rate_of_w = load(&p.inverse_inertia[i]).x;
    const auto moves = inverse_mass > zero, turns = rate_of_w > zero;
    const bool all_turn = !any(!turns);
    const Lane3 force = load_rows(on, kForce), torque = load_rows(on, kTorque);

    // the second kick of the step, kick_row() of motion.cpp
    const Lane3 v0 = load(&p.v[i]), L0 = load(&p.L[i]), push = (half_step * inverse_mass) * force, turning = half_step * torque;
    const Lane3 v1 = select(moves, v0 + push, v0), L1 = L0 + turning;
    const Lane3 w0 = all_turn ? Lane3{zero, zero, zero} : load(&p.w[i]), w1 = select(turns, rate_of_w * L1, w0);

    // add_dissipation_of_rows()
    const Lane power = dot(load_rows(on, kLost), v1) + dot(load_rows(on, kLostTorque), w1);
    (Lane::load(&p.dissipated[i]) + select(moves, time * power, zero)).store(&p.dissipated[i]);

    // the first kick of the next step and its drift, kick_and_drift_row()
    const Lane3 v2 = v1 + push, way = step * v2, x0 = load(&p.x[i]), left0 = load(&p.x_remainder[i]);
    Lane3 x = x0, left = left0;
    advance(x.x, left.x, way.x);
    advance(x.y, left.y, way.y);
    advance(x.z, left.z, way.z);
    const Lane3 v = select(moves, v2, v1);
    x = select(moves, x, x0);
    store(v, &p.v[i]);
    store(x, &p.x[i]);
    store(select(moves, left, left0), &p.x_remainder[i]);

    const Lane3 L2 = L1 + turning, spin = rate_of_w * L2, w = select(turns, spin, w1);
    const Lane rate = length(spin);
    const auto rotates = turns & (rate > zero);
    const LaneQuat q0 = load(&p.q[i]), rest0 = load(&p.q_remainder[i]);
    LaneQuat q = q0, rest = rest0;
    turn_about(spin, rate, step, q, rest);
    store(select(turns, L2, L0), &p.L[i]);
    store(w, &p.w[i]);
    store(select(rotates, q, q0), &p.q[i]);
    store(select(rotates, rest, rest0), &p.q_remainder[i]);

    double* const rows = &motion.rows[i].x.v.x;
    constexpr std::size_t kStride = sizeof(BallRow) / sizeof(double);
    const Lane radius = Lane::load(&p.ball_radius[i]);
    store_rows(x, zero, rows, kStride);
    store_rows(v, zero, rows + 4, kStride);
    store_rows(w, zero, rows + 8, kStride);
    store_rows(radius * w, zero, rows + 12, kStride);
    const Lane speed = dot(v, v);
    fastest = Lane{select(speed > fastest, speed, fastest)};
  }
  alignas(64) double speeds[kLanes];
  fastest.store(speeds);
  return *std::max_element(speeds, speeds + kLanes);
}

/// As far as whole vectors go.   out   done   the first row that is left
HWY_NOINLINE double move_whole_vectors(const BallMotion& motion, std::size_t begin, std::size_t end, ParticleSet& p, std::size_t& done) {
  done = begin + (end - begin) / kLanes * kLanes;
  const bool asks = asks_for_slots(motion.sums);
  if (motion.sums.moments != nullptr) return asks ? move_rows<true, true>(motion, begin, done, p) : move_rows<true, false>(motion, begin, done, p);
  return asks ? move_rows<false, true>(motion, begin, done, p) : move_rows<false, false>(motion, begin, done, p);
}

}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scree {
namespace {
HWY_EXPORT(move_whole_vectors);
}

double move_balls(const BallMotion& motion, std::size_t begin, std::size_t end, ParticleSet& p) {
  std::size_t i = begin;
  double squared = HWY_DYNAMIC_DISPATCH(move_whole_vectors)(motion, begin, end, p, i);
  for (std::size_t k = i; k < end; ++k) {
    if (motion.summed[k] == 0) sum_onto_balls(motion.sums, motion.gravity, k, k + 1, p);
  }
  if (i == end) return squared;
  end_step_of_balls(p, motion.dt, i, end);
  add_dissipation_of_rows(p, motion.dt, i, end);
  begin_step_of_balls(p, motion.dt, i, end);
  collect_ball_rows(p, i, end, motion.rows);
  for (std::size_t k = i; k < end; ++k) squared = std::max(squared, squared_length(p.v[k]));
  return squared;
}

}  // namespace scree
#endif
