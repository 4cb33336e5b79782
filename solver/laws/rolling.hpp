// Rolling and torsional resistance of a body pair: a moment against the relative spin, split into its part along the contact
// normal (torsion) and across it (rolling). For bodies of true shape it is usually left out: the shape rolls as it does.
//
// Type C (default): an elastic spring of moment that yields at mu R* N, with the stiffness and damping that the friction
// spring of the pair would have at the lever R*; it holds a body at rest. Type A: a constant moment mu R* N against the spin.
// Sources: Ai et al., Powder Technol. 206 (2011) 269 (types A and C); Wensrich & Katterfeld, Powder Technol. 217 (2012) 409.
#pragma once

#include <algorithm>

#include "core/geometry/vec3.hpp"
#include "solver/laws/pair_law.hpp"
#include "solver/laws/real.hpp"

namespace scree {

#define SCREE_LAW inline
#include "solver/laws/rolling-inl.hpp"
#undef SCREE_LAW

/// Constant moment against a spin; in one step it never does more than stop it.
inline Vec3 constant_moment(const Vec3& spin, double limit, double mobility, double dt) {
  const double rate = length(spin);
  if (!(rate > 0)) return {};
  const double stop = mobility * dt > 0 ? rate / (mobility * dt) : limit;
  return (-std::min(limit, stop) / rate) * spin;
}

/// in   spin_mobility   a bound of the inverse inertia of the relative spin [1/(kg m^2)]
/// in   old      the spring of the last step [N m], and the stiffness it had (0: none)
/// in   dt       step of the run [s]     in  spring_dt  dt, or 0 to leave the spring as it is
inline RollingMoment rolling_moment(const PairLaw& law, const RollingState& s, double spin_mobility, const Vec3& old, double old_stiffness,
                                    double dt, double spring_dt) {
  if (law.rolling_spring) return rolling_spring(s, old, old_stiffness, spring_dt);
  const Vec3 twist = dot(s.relative_spin, s.n) * s.n, roll = s.relative_spin - twist;
  return {constant_moment(roll, s.roll_limit, spin_mobility, dt) + constant_moment(twist, s.twist_limit, spin_mobility, dt), {}, 0};
}

}  // namespace scree
