// What a contact does in lanes, once for balls (ball_forces.cpp) and for meshes (mesh_forces.cpp): how much of the push damping takes away
// or adds, and the spring of friction. Included by them once for every instruction set.
//
// The formulas are those of single pairs, one text (laws/damping-inl.hpp, friction-inl.hpp, rolling-inl.hpp). Roots and quotients that
// only contacts need which slide, begin or lose load are made where at least one lane has such a contact: they were a third of the time of
// a bed at rest.
#if defined(SCREE_SOLVER_CONTACT_LANE_CONTACT_INL_HPP_) == defined(HWY_TARGET_TOGGLE)
#ifdef SCREE_SOLVER_CONTACT_LANE_CONTACT_INL_HPP_
#undef SCREE_SOLVER_CONTACT_LANE_CONTACT_INL_HPP_
#else
#define SCREE_SOLVER_CONTACT_LANE_CONTACT_INL_HPP_
#endif

#include <hwy/highway.h>

#include "solver/lanes/ball_lanes-inl.hpp"
#include "solver/laws/ball.hpp"

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {

#define SCREE_LAW HWY_INLINE
#include "solver/laws/damping-inl.hpp"
#include "solver/laws/friction-inl.hpp"
#include "solver/laws/rolling-inl.hpp"
// made of those
#include "solver/laws/ball-inl.hpp"
#undef SCREE_LAW

/// PairDamping and Damping of the pairs.
struct LaneDamping {
  Lane chi;           ///< damping over push and speed [s/m]
  Lane rate, lagged;  ///< of the damping in a step, and what chi was divided by for it
  Mask<double> fits;  ///< lanes have the formula
};

/// in   energy [J], push [N], mobility [1/kg]   of each pair
template <LaneLawKind kKind>
HWY_INLINE LaneDamping damping_of(const LawRows<LaneLaw>& law, Lane energy, Lane push, Lane mobility, Lane step) {
  constexpr bool kViscous = kKind != LaneLawKind::linear_hunt_crossley;
  Lane chi = law.at(&LaneLaw::damping), lagged(1.0);
  if constexpr (kViscous) chi = viscous_chi(chi, energy, mobility);
  const Lane rate = chi * push * mobility * step, free_rate(kViscous ? ViscousDamping::kFreeRate : HuntCrossleyDamping::kFreeRate);
  if constexpr (kViscous) {
    lagged = lag_of(rate);
    chi = chi / lagged;
  }
  return {chi, rate, lagged, (push > Lane(0.0)) & (rate <= free_rate)};
}

/// The push of a contact with its damping [N].   in   vn   at which the surfaces part [m/s]
template <LaneLawKind kKind>
HWY_INLINE Lane damped_push(const LaneDamping& damping, Lane push, Lane overlap, Lane vn, Lane step) {
  const Lane one(1.0), closing = (-vn) * step;
  Lane weight = one;  // never above the most that it may be
  if (any(overlap < closing)) {
    Lane most = one;
    if constexpr (kKind != LaneLawKind::linear_hunt_crossley)
      most = most_onset_of(damping.rate, damping.lagged, Lane(ViscousDamping::kMaxOnset));
    const Lane onset = onset_weight(overlap, closing);
    weight = select(onset < most, onset, most);
  }
  return damped_push(push, damping.chi, weight, vn, Lane(0.0));
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

/// PairFriction of the pairs.
struct LaneFriction {
  HalfTurn turned;
  Lane friction, sliding, tangential_ratio, damping;  ///< mu, ..., rho, damping of sliding over the push
  Lane rounding;                                      ///< change of the stiffness times overlap that is none [m]

  /// PairFriction::force of one contact of each pair.   in   D   effective overlap of the pair, `kept`: has a spring from the step before
  /// out   spring   in and out
  HWY_INLINE Lane3 force(const LaneContact& c, Lane D, Mask<double> kept, Lane step, LaneSpring& spring) const {
    const Lane3 carried = transported(turned_by(turned, spring.force), turned_by(turned, spring.normal), c.n);
    const SlidingContact contact{
        c.n, c.vt, c.vn, c.overlap, tangential_ratio * (c.push / D), damping * c.push, friction * c.damped, sliding * c.damped};
    ContactSpring next{carried, spring.stiffness};
    Lane stretched;
    const Lane3 tangential = friction_force(contact, kept, carried, rounding, step, next, stretched);
    spring = {next.force, next.stiffness, c.n};
    return tangential;
  }
};

// NOLINTNEXTLINE(google-readability-namespace-comments)
}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
