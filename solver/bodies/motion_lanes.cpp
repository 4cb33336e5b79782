// Compiled once for every instruction set (Highway's foreach_target), for the baseline, never with -march=native. A body that is fixed or
// does not turn keeps what it has: 1/m and I^-1 say which these are, they are 0 then and never otherwise.
#include "solver/bodies/motion_lanes.hpp"

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

/// Bodies whose moments are equal: one exact rotation about w.
HWY_INLINE void turn_rows(ParticleSet& p, double kick_time, double h, std::size_t i) {
  constexpr double kUnitError = 8 * std::numeric_limits<double>::epsilon();  // as in keep_unit() of motion.cpp
  const Lane zero(0.0), half(0.5), one(1.0);
  const Lane rate_of_w = load(&p.inverse_inertia[i]).x;
  const Lane3 L = load(&p.L[i]), next = L + Lane(kick_time) * load(&p.torque[i]), w = rate_of_w * next;
  const auto turns = rate_of_w > zero;
  store(select(turns, next, L), &p.L[i]);
  store(select(turns, w, load(&p.w[i])), &p.w[i]);
  const Lane rate = length(w);
  const auto rotates = turns & (rate > zero);
  Lane s, c;
  sine_and_cosine(half * (rate * Lane(h)), s, c);
  const Lane3 axis = (one / rate) * w;
  LaneQuat q = load(&p.q[i]), remainder = load(&p.q_remainder[i]);
  const LaneQuat before = q, remainder_before = remainder;
  advance(q, remainder, LaneQuat{c - one, s * axis.x, s * axis.y, s * axis.z} * q);
  const Lane excess = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z - one, by = Lane(-0.5) * excess;
  const auto is_off = abs(excess) > Lane(kUnitError);
  LaneQuat unit = q, unit_remainder = remainder;
  advance(unit, unit_remainder, LaneQuat{by * q.w, by * q.x, by * q.y, by * q.z});
  store(select(rotates, select(is_off, unit, q), before), &p.q[i]);
  store(select(rotates, select(is_off, unit_remainder, remainder), remainder_before), &p.q_remainder[i]);
}

HWY_NOINLINE std::size_t drift_rows(ParticleSet& p, double kick_time, double h, std::size_t begin, std::size_t end) {
  const Lane zero(0.0), time(kick_time), step(h);
  std::size_t i = begin;
  for (; i + kLanes <= end; i += kLanes) {
    for (std::size_t k = 0; k < kLanes; ++k)
      if (p.isotropic[i + k] == 0) return i;
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
    if constexpr (built_with::kRotation) turn_rows(p, kick_time, h, i);
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

std::size_t drift_in_lanes(ParticleSet& p, double kick_time, double h, std::size_t begin, std::size_t end) {
  return HWY_DYNAMIC_DISPATCH(drift_rows)(p, kick_time, h, begin, end);
}

}  // namespace scree
#endif
