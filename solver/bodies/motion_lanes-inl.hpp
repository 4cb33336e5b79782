// Columns of bodies in lanes, and what a drift does to a place and to an orientation: what motion_lanes.cpp and lanes/ball_motion.cpp
// share. Included by them once for every instruction set.
#if defined(SCREE_SOLVER_BODIES_MOTION_LANES_INL_HPP_) == defined(HWY_TARGET_TOGGLE)
#ifdef SCREE_SOLVER_BODIES_MOTION_LANES_INL_HPP_
#undef SCREE_SOLVER_BODIES_MOTION_LANES_INL_HPP_
#else
#define SCREE_SOLVER_BODIES_MOTION_LANES_INL_HPP_
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <limits>

#include "solver/bodies/lanes-inl.hpp"
#include "solver/bodies/sine_cosine.hpp"

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

/// As add_turn() of motion.cpp: q after what is added to it, a unit quaternion.
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

/// As sine_ratio_and_less_one().
HWY_INLINE void sine_ratio_and_less_one(Lane aa, Lane& ratio, Lane& less_one) {
  ratio = Lane(1.0) - aa * (Lane(1.0 / 6) - aa * (Lane(1.0 / 120) - aa * (Lane(1.0 / 5040) - aa * Lane(1.0 / 362880))));
  less_one = (-aa) * (Lane(0.5) - aa * (Lane(1.0 / 24) - aa * (Lane(1.0 / 720) - aa * Lane(1.0 / 40320))));
  if (!any(!(aa <= Lane(kSmallAngle * kSmallAngle)))) return;
  alignas(64) double squares[kLanes], ratios[kLanes], others[kLanes];
  aa.store(squares);
  for (std::size_t k = 0; k < kLanes; ++k) scree::sine_ratio_and_less_one(squares[k], ratios[k], others[k]);
  ratio = Lane::load(ratios);
  less_one = Lane::load(others);
}

/// One exact rotation about w over a time h, as rotate_by() of motion.cpp.   in   aa   square of half the angle
HWY_INLINE void turn_about(const Lane3& w, Lane aa, Lane half_step, LaneQuat& q, LaneQuat& remainder) {
  Lane ratio, less_one;
  sine_ratio_and_less_one(aa, ratio, less_one);
  const Lane3 axis = (half_step * ratio) * w;
  add_turn(q, remainder, LaneQuat{less_one, axis.x, axis.y, axis.z} * q);
}

// NOLINTNEXTLINE(google-readability-namespace-comments)
}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
