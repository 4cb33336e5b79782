// Compiled once for every instruction set (Highway's foreach_target), for the baseline, never with -march=native. A body that is fixed or
// does not turn keeps what it has: 1/m and I^-1 say which these are, they are 0 then and never otherwise.
#include "solver/bodies/motion_lanes.hpp"

#include <cstdint>

#include "solver/built_with.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solver/bodies/motion_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "solver/bodies/motion_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {

/// Which of the bodies in the lanes have equal moments. Asked of all lanes at once, since most vectors have bodies of one kind.
struct Balls {
  const std::uint8_t* isotropic;
  bool all = true, some = false;
  HWY_INLINE explicit Balls(const std::uint8_t* flags) : isotropic(flags) {
    std::uint8_t both = 0xff, either = 0;
    for (std::size_t k = 0; k < kLanes; ++k) {
      both &= flags[k];
      either |= flags[k];
    }
    all = both != 0;
    some = either != 0;
  }
  HWY_INLINE Mask<double> lanes() const {
    alignas(64) double numbers[kLanes];
    for (std::size_t k = 0; k < kLanes; ++k) numbers[k] = isotropic[k];
    return Lane::load(numbers) > Lane(0.0);
  }
};

HWY_NOINLINE std::size_t kick_rows(ParticleSet& p, double h, std::size_t begin, std::size_t end) {
  const Lane zero(0.0), time(h);
  std::size_t i = begin;
  for (; i + kLanes <= end; i += kLanes) {
    const Lane inverse_mass = Lane::load(&p.inverse_mass[i]);
    const auto moves = inverse_mass > zero;
    const Lane3 v = load(&p.v[i]);
    store(select(moves, v + (time * inverse_mass) * load(&p.force[i]), v), &p.v[i]);
    if constexpr (!built_with::kRotation) continue;
    const Lane3 by = load(&p.inverse_inertia[i]), L = load(&p.L[i]), w = load(&p.w[i]);
    const auto turns = by.x > zero;
    const Lane3 next = L + time * load(&p.torque[i]);
    store(select(turns, next, L), &p.L[i]);
    const Balls balls(&p.isotropic[i]);
    Lane3 spin = by.x * next;  // where the moments are equal
    if (!balls.all) {
      const LaneQuat q = load(&p.q[i]);
      const Lane3 l = rotate_inverse(q, next), turned = rotate(q, Lane3{l.x * by.x, l.y * by.y, l.z * by.z});
      spin = balls.some ? select(balls.lanes(), spin, turned) : turned;
    }
    store(select(turns, spin, w), &p.w[i]);
  }
  return i;
}

/// Bodies whose moments are equal, the lanes of `which`: one exact rotation about w.
HWY_INLINE void turn_rows(ParticleSet& p, double kick_time, double h, std::size_t i, Mask<double> which) {
  const Lane zero(0.0);
  const Lane rate_of_w = load(&p.inverse_inertia[i]).x;
  const Lane3 L = load(&p.L[i]), next = L + Lane(kick_time) * load(&p.torque[i]), w = rate_of_w * next;
  const auto turns = which & (rate_of_w > zero);
  const Lane half(0.5 * h), aa = (half * half) * dot(w, w);
  const auto rotates = turns & (aa > zero);
  const LaneQuat before = load(&p.q[i]), remainder_before = load(&p.q_remainder[i]);
  LaneQuat q = before, remainder = remainder_before;
  turn_about(w, aa, half, q, remainder);
  if (!any(!rotates)) {  // nearly always
    store(next, &p.L[i]);
    store(w, &p.w[i]);
    store(q, &p.q[i]);
    store(remainder, &p.q_remainder[i]);
    return;
  }
  store(select(turns, next, L), &p.L[i]);
  store(select(turns, w, load(&p.w[i])), &p.w[i]);
  store(select(rotates, q, before), &p.q[i]);
  store(select(rotates, remainder, remainder_before), &p.q_remainder[i]);
}

/// As turn() of motion.cpp: rotation by `angle` about a principal axis i, with j and k after it.
HWY_INLINE void turn_about_axis(Lane angle, Lane& qw, Lane& qi, Lane& qj, Lane& qk, Lane& lj, Lane& lk) {
  Lane s, c;
  sine_and_cosine(Lane(0.5) * angle, s, c);
  const Lane w = qw, i = qi, j = qj, k = qk, two(2.0);
  qw = c * w - s * i;
  qi = c * i + s * w;
  qj = c * j + s * k;
  qk = c * k - s * j;
  const Lane cosine = Lane(1.0) - two * s * s, sine = two * s * c, old = lj;
  lj = cosine * lj + sine * lk;
  lk = cosine * lk - sine * old;
}

/// Bodies whose moments differ, the lanes of `which`: DlmRotor of motion.cpp.
HWY_INLINE void rotor_rows(ParticleSet& p, double kick_time, double h, std::size_t i, Mask<double> which) {
  const Lane zero(0.0), one(1.0), step(h), half_step = Lane(0.5) * step;
  const Lane3 by = load(&p.inverse_inertia[i]);
  const auto turns = which & (by.x > zero);
  const Lane3 L = load(&p.L[i]), next = L + Lane(kick_time) * load(&p.torque[i]);
  const LaneQuat before = load(&p.q[i]), remainder_before = load(&p.q_remainder[i]);
  Lane3 l = rotate_inverse(before, next);
  LaneQuat r{one, zero, zero, zero};
  turn_about_axis(half_step * l.z * by.z, r.w, r.z, r.x, r.y, l.x, l.y);
  turn_about_axis(half_step * l.y * by.y, r.w, r.y, r.z, r.x, l.z, l.x);
  turn_about_axis(step * l.x * by.x, r.w, r.x, r.y, r.z, l.y, l.z);
  turn_about_axis(half_step * l.y * by.y, r.w, r.y, r.z, r.x, l.z, l.x);
  turn_about_axis(half_step * l.z * by.z, r.w, r.z, r.x, r.y, l.x, l.y);
  LaneQuat q = before, remainder = remainder_before;
  add_turn(q, remainder, q * LaneQuat{r.w - one, r.x, r.y, r.z});
  const Lane3 there = rotate_inverse(q, next);
  store(select(turns, next, L), &p.L[i]);
  store(select(turns, rotate(q, Lane3{there.x * by.x, there.y * by.y, there.z * by.z}), load(&p.w[i])), &p.w[i]);
  store(select(turns, q, before), &p.q[i]);
  store(select(turns, remainder, remainder_before), &p.q_remainder[i]);
}

HWY_NOINLINE std::size_t drift_rows(ParticleSet& p, double kick_time, double h, bool has_rotor, std::size_t begin, std::size_t end) {
  const Lane zero(0.0), time(kick_time), step(h);
  std::size_t i = begin;
  for (; i + kLanes <= end; i += kLanes) {
    const Balls balls(&p.isotropic[i]);
    if (!has_rotor && !balls.all) return i;
    const Lane inverse_mass = Lane::load(&p.inverse_mass[i]);
    const auto moves = inverse_mass > zero;
    const Lane3 v = load(&p.v[i]), next = v + (time * inverse_mass) * load(&p.force[i]), way = step * next, x = load(&p.x[i]),
                remainder = load(&p.x_remainder[i]);
    Lane3 there = x, left = remainder;
    advance(there.x, left.x, way.x);
    advance(there.y, left.y, way.y);
    advance(there.z, left.z, way.z);
    store(select(moves, next, v), &p.v[i]);
    store(select(moves, there, x), &p.x[i]);
    store(select(moves, left, remainder), &p.x_remainder[i]);
    if constexpr (!built_with::kRotation) continue;
    if (balls.all) {
      turn_rows(p, kick_time, h, i, zero < Lane(1.0));
      continue;
    }
    const auto isotropic = balls.lanes();
    if (balls.some) turn_rows(p, kick_time, h, i, isotropic);
    rotor_rows(p, kick_time, h, i, !isotropic);
  }
  return i;
}

}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scree {
namespace {

HWY_EXPORT(kick_rows);
HWY_EXPORT(drift_rows);

}  // namespace

std::size_t kick_in_lanes(ParticleSet& p, double h, std::size_t begin, std::size_t end) {
  return HWY_DYNAMIC_DISPATCH(kick_rows)(p, h, begin, end);
}

std::size_t drift_in_lanes(ParticleSet& p, double kick_time, double h, bool has_rotor, std::size_t begin, std::size_t end) {
  return HWY_DYNAMIC_DISPATCH(drift_rows)(p, kick_time, h, has_rotor, begin, end);
}

}  // namespace scree
#endif
