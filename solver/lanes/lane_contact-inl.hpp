// What a contact does in lanes, once for balls (ball_forces.cpp) and for meshes (mesh_forces.cpp): how much of the push damping takes away
// or adds, and the spring of friction. Included by them once for every instruction set.
//
// The order of operations is that of laws/damping.hpp, chosen_law.cpp and pair_friction.hpp, line by line: whoever changes one changes
// both. Roots and quotients that only contacts need which slide, begin or lose load are made where at least one lane has such a contact:
// they were a third of the time of a bed at rest. Lanes that have none then keep what a factor of 1 would have left as it was, to the bit.
#if defined(SCREE_SOLVER_CONTACT_LANE_CONTACT_INL_HPP_) == defined(HWY_TARGET_TOGGLE)
#ifdef SCREE_SOLVER_CONTACT_LANE_CONTACT_INL_HPP_
#undef SCREE_SOLVER_CONTACT_LANE_CONTACT_INL_HPP_
#else
#define SCREE_SOLVER_CONTACT_LANE_CONTACT_INL_HPP_
#endif

#include <hwy/highway.h>

#include "solver/contact/pair_friction.hpp"
#include "solver/lanes/ball_lanes-inl.hpp"
#include "solver/laws/damping.hpp"

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {

/// PairDamping and Damping of the pairs.
struct LaneDamping {
  Lane chi;           ///< damping over push and speed [s/m]
  Lane rate, lagged;  ///< of the damping in a step, and what chi was divided by for it
  Mask<double> fits;  ///< lanes have the formula
};

/// in   energy [J], push [N], mobility [1/kg]   of each pair
template <LaneLawKind kKind>
HWY_INLINE LaneDamping damping_of(const LawRows<LaneLaw>& law, Lane energy, Lane push, Lane mobility, Lane step) {
  const Lane one(1.0);
  Lane chi = law.at(&LaneLaw::damping), lagged = one, free_rate(HuntCrossleyDamping::kFreeRate);
  if constexpr (kKind != LaneLawKind::linear_hunt_crossley) {
    chi = chi / sqrt(Lane(2.0) * energy * mobility);
    free_rate = Lane(ViscousDamping::kFreeRate);
  }
  const Lane rate = chi * push * mobility * step;
  if constexpr (kKind != LaneLawKind::linear_hunt_crossley) {
    lagged = one + Lane(0.25) * rate;
    chi = chi / lagged;
  }
  return {chi, rate, lagged, (push > Lane(0.0)) & (rate <= free_rate)};
}

/// How much of its damping a contact feels: all, but for those that began within the step.
template <LaneLawKind kKind>
HWY_INLINE Lane onset_of(const LaneDamping& damping, Lane overlap, Lane closing) {
  const Lane zero(0.0), one(1.0);
  const auto begins = overlap < closing;
  if (!any(begins)) return one;  // never above the most that it may be
  Lane most_onset = one;
  if constexpr (kKind != LaneLawKind::linear_hunt_crossley) {
    const Lane most(ViscousDamping::kMaxOnset), onset = damping.lagged / damping.rate;
    most_onset = select(damping.rate > zero, select(onset < one, one, select(most < onset, most, onset)), one);
  }
  const Lane onset = select(begins, overlap / closing + Lane(0.5), one);
  return select(onset < most_onset, onset, most_onset);
}

/// The push of a contact with its damping [N].   in   vn   at which the surfaces part [m/s]
template <LaneLawKind kKind>
HWY_INLINE Lane damped_push(const LaneDamping& damping, Lane push, Lane overlap, Lane vn, Lane step) {
  const Lane zero(0.0), weight = onset_of<kKind>(damping, overlap, (-vn) * step), share = Lane(1.0) - damping.chi * weight * vn;
  return push * select(zero < share, share, zero);
}

/// A contact of each pair, A frame.
struct LaneContact {
  Lane3 n, vt;   ///< from B to A; speed of sliding [m/s]
  Lane overlap;  ///< [m]
  Lane vn;       ///< [m/s]
  Lane push, damped;
};

/// A spring of each pair, as in FrictionSpring.
struct LaneSpring {
  Lane3 force;
  Lane stiffness;
  Lane3 normal;
};

/// transported().
HWY_INLINE Lane3 transported(const Lane3& spring, const Lane3& n, const Lane3& m) {
  const Lane zero(0.0), c = Lane(1.0) + dot(n, m);
  return select(c > Lane(kOppositeNormal), spring - (dot(spring, m) / c) * (n + m), Lane3{zero, zero, zero});
}

/// PairFriction of the pairs.
struct LaneFriction {
  LaneTurn turned;
  Lane friction, sliding, tangential_ratio, damping;  ///< mu, ..., rho, damping of sliding over the push
  Lane rounding;                                      ///< change of the stiffness times overlap that is none [m]

  /// PairFriction::force of one contact of each pair.   in   D   effective overlap of the pair, `kept`: has a spring from the step before
  /// out   spring   in and out
  HWY_INLINE Lane3 force(const LaneContact& c, Lane D, Mask<double> kept, Lane step, LaneSpring& spring) const {
    const Lane zero(0.0), one(1.0), before = abs(spring.stiffness);
    Lane3 s = transported(turned.of(spring.force), turned.of(spring.normal), c.n);
    // no more of it than the load allows, and no change of the load that is rounding
    const Lane fresh = tangential_ratio * (c.push / D);
    const auto same = abs(fresh - before) * c.overlap <= rounding * before;
    const Lane kappa = select(kept & same, before, fresh);
    if (const auto unloads = kappa < before; any(unloads)) s = select(unloads, kappa / before, one) * s;
    Lane3 next = s - (kappa * step) * c.vt;
    if (any(!kept)) {  // one that touches since has slid only since then
      const Lane since = select((c.overlap > zero) & (c.overlap < (-c.vn) * step), c.overlap / (-c.vn), step);
      next = select(kept, next, ((-kappa) * since) * c.vt);
    }
    const Lane sliding_limit = sliding * c.damped;
    const auto slid = kept & (spring.stiffness < zero) & (dot(next, c.vt) < zero);
    const Lane limit = select(slid, sliding_limit, friction * c.damped);
    const Lane stretched = dot(next, next);
    const auto yields = stretched > limit * limit, slides = slid | yields;
    if (any(yields)) next = select(yields, sliding_limit / sqrt(stretched), one) * next;
    Lane3 tangential = next - (damping * c.push) * c.vt;
    const Lane total = dot(tangential, tangential), cap = select(slides, sliding_limit, limit);
    if (const auto is_above = total > cap * cap; any(is_above)) tangential = select(is_above, cap / sqrt(total), one) * tangential;
    spring = {next, select(slides, -kappa, kappa), c.n};
    return tangential;
  }
};

/// What a spring stores, added to `stored` [J].
HWY_INLINE Lane with_energy(const LaneSpring& spring, Lane stored) {
  const Lane kappa = abs(spring.stiffness);
  return select(kappa > Lane(0.0), stored + Lane(0.5) * dot(spring.force, spring.force) / kappa, stored);
}

// NOLINTNEXTLINE(google-readability-namespace-comments)
}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
