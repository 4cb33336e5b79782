// Rolling and torsional resistance (solver/laws/rolling.hpp, type C) with a pair of balls in each lane, operation by operation. Included
// once for every instruction set by ball_forces.cpp.
#if defined(SCREE_SOLVER_CONTACT_BALL_ROLLING_INL_HPP_) == defined(HWY_TARGET_TOGGLE)
#ifdef SCREE_SOLVER_CONTACT_BALL_ROLLING_INL_HPP_
#undef SCREE_SOLVER_CONTACT_BALL_ROLLING_INL_HPP_
#else
#define SCREE_SOLVER_CONTACT_BALL_ROLLING_INL_HPP_
#endif

#include "solver/bodies/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {

/// RollingState and what of the law goes with it.
struct LaneRolling {
  Lane3 n, relative_spin;
  Lane normal_force, overlap, radius, damping;
  Lane roll_limit, twist_limit, tangential_ratio;
};
struct LaneMoment {
  Lane3 moment, spring;
  Lane stiffness;
};

HWY_INLINE Lane3 yield(const Lane3& spring, const Lane3& damping, Lane limit, Lane3& kept) {
  const Lane stretched = length(spring);
  const auto slides = stretched > limit;
  kept = select(slides, (limit / stretched) * spring, spring);
  const Lane3 total = select(slides, kept, kept + damping);
  const Lane size = length(total);
  return select(size > limit, (limit / size) * total, total);
}

HWY_INLINE LaneMoment rolling_moment(const LaneRolling& s, const Lane3& old, Lane old_stiffness, Lane dt) {
  LaneMoment result;
  const Lane one(1.0);
  const Lane3 twist = dot(s.relative_spin, s.n) * s.n, roll = s.relative_spin - twist;
  result.stiffness = s.tangential_ratio * s.normal_force / s.overlap * s.radius * s.radius;
  Lane3 spring = select(result.stiffness < old_stiffness, result.stiffness / old_stiffness, one) * old;
  spring = spring - (result.stiffness * dt) * s.relative_spin;
  const Lane3 spring_twist = dot(spring, s.n) * s.n;
  const Lane c = s.damping * s.normal_force * s.radius * s.radius;
  Lane3 kept_roll, kept_twist;
  result.moment = yield(spring - spring_twist, (-c) * roll, s.roll_limit, kept_roll);
  result.moment = result.moment + yield(spring_twist, (-c) * twist, s.twist_limit, kept_twist);
  result.spring = kept_roll + kept_twist;
  return result;
}

// NOLINTNEXTLINE(google-readability-namespace-comments)
}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
