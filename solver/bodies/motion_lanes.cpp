// Compiled once for every instruction set (Highway's foreach_target), for the baseline, never with -march=native. A body that is fixed or
// does not turn keeps what it has: 1/m and I^-1 say which these are, they are 0 then and never otherwise.
#include "solver/bodies/motion_lanes.hpp"

#include <cstdint>
#include <limits>

#include "solver/bodies/sine_cosine.hpp"
#include "solver/built_with.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solver/bodies/motion_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "solver/bodies/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {

HWY_INLINE Lane3 load(const Vec3* rows) {
  Lane3 v;
  hn::LoadInterleaved3(Tag<double>(), &rows->x, v.x.v, v.y.v, v.z.v);
  return v;
}
HWY_INLINE LaneQuat load(const Quat* rows) {
  LaneQuat q;
  hn::LoadInterleaved4(Tag<double>(), &rows->w, q.w.v, q.x.v, q.y.v, q.z.v);
  return q;
}
HWY_INLINE void store(const Lane3& v, Vec3* rows) { hn::StoreInterleaved3(v.x.v, v.y.v, v.z.v, Tag<double>(), &rows->x); }
HWY_INLINE void store(const LaneQuat& q, Quat* rows) { hn::StoreInterleaved4(q.w.v, q.x.v, q.y.v, q.z.v, Tag<double>(), &rows->w); }

HWY_INLINE LaneQuat select(Mask<double> m, const LaneQuat& yes, const LaneQuat& no) {
  return {select(m, yes.w, no.w), select(m, yes.x, no.x), select(m, yes.y, no.y), select(m, yes.z, no.z)};
}

/// As advance() of motion.cpp.
HWY_INLINE void advance(Lane& x, Lane& remainder, Lane way) {
  way = way + remainder;
  const Lane sum = x + way, added = sum - x;
  remainder = (x - (sum - added)) + (way - added);
  x = sum;
}
HWY_INLINE void advance(LaneQuat& q, LaneQuat& remainder, const LaneQuat& way) {
  advance(q.w, remainder.w, way.w);
  advance(q.x, remainder.x, way.x);
  advance(q.y, remainder.y, way.y);
  advance(q.z, remainder.z, way.z);
}

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
    const LaneQuat q = load(&p.q[i]);
    const Lane3 next = L + time * load(&p.torque[i]), l = rotate_inverse(q, next);
    store(select(turns, next, L), &p.L[i]);
    store(select(turns, rotate(q, Lane3{l.x * by.x, l.y * by.y, l.z * by.z}), w), &p.w[i]);
  }
  return i;
}

/// As sine_and_cosine() of one angle.
HWY_INLINE void sine_and_cosine(Lane a, Lane& sine, Lane& cosine) {
  if (!any(abs(a) > Lane(kSmallAngle))) {
    const Lane aa = a * a, one(1.0);
    sine = a - a * aa * (Lane(1.0 / 6) - aa * (Lane(1.0 / 120) - aa * (Lane(1.0 / 5040) - aa * Lane(1.0 / 362880))));
    cosine = one - aa * (Lane(0.5) - aa * (Lane(1.0 / 24) - aa * (Lane(1.0 / 720) - aa * Lane(1.0 / 40320))));
    return;
  }
  alignas(64) double angle[kLanes], sines[kLanes], cosines[kLanes];
  a.store(angle);
  for (std::size_t k = 0; k < kLanes; ++k) scree::sine_and_cosine(angle[k], sines[k], cosines[k]);
  sine = Lane::load(sines);
  cosine = Lane::load(cosines);
}

/// As turn_in_body() and turn_in_world() of motion.cpp: q after what is added to it, a unit quaternion.
HWY_INLINE void add_turn(LaneQuat& q, LaneQuat& remainder, const LaneQuat& way) {
  constexpr double kUnitError = 8 * std::numeric_limits<double>::epsilon();  // as in keep_unit() of motion.cpp
  advance(q, remainder, way);
  const Lane excess = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z - Lane(1.0), by = Lane(-0.5) * excess;
  const auto is_off = abs(excess) > Lane(kUnitError);
  if (!any(is_off)) return;
  LaneQuat unit = q, unit_remainder = remainder;
  advance(unit, unit_remainder, LaneQuat{by * q.w, by * q.x, by * q.y, by * q.z});
  q = select(is_off, unit, q);
  remainder = select(is_off, unit_remainder, remainder);
}

/// Bodies whose moments are equal, the lanes of `which`: one exact rotation about w.
HWY_INLINE void turn_rows(ParticleSet& p, double kick_time, double h, std::size_t i, Mask<double> which) {
  const Lane zero(0.0), half(0.5), one(1.0);
  const Lane rate_of_w = load(&p.inverse_inertia[i]).x;
  const Lane3 L = load(&p.L[i]), next = L + Lane(kick_time) * load(&p.torque[i]), w = rate_of_w * next;
  const auto turns = which & (rate_of_w > zero);
  const Lane rate = length(w);
  const auto rotates = turns & (rate > zero);
  Lane s, c;
  sine_and_cosine(half * (rate * Lane(h)), s, c);
  const Lane3 axis = (one / rate) * w;
  const LaneQuat before = load(&p.q[i]), remainder_before = load(&p.q_remainder[i]);
  LaneQuat q = before, remainder = remainder_before;
  add_turn(q, remainder, LaneQuat{c - one, s * axis.x, s * axis.y, s * axis.z} * q);
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
