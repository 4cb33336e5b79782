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

namespace scree {

/// What the pair is at this step.
struct RollingState {
  Vec3 n;                    ///< mean contact normal, unit
  Vec3 relative_spin;        ///< of A against B [rad/s]
  double normal_force = 0;   ///< N [N], elastic
  double overlap = 0;        ///< D [m]
  double radius = 0;         ///< R* [m]
  double damping = 0;        ///< tangential damping over normal force [s/m]
  double spin_mobility = 0;  ///< a bound of the inverse inertia of the relative spin [1/(kg m^2)]
};

/// Moment on A and its spring, both with the part along n and the part across it in one vector.
struct RollingMoment {
  Vec3 moment;           ///< on A [N m]
  Vec3 spring;           ///< elastic part, to be kept [N m]
  double stiffness = 0;  ///< [N m/rad]
};

namespace rolling {

/// One of the two parts: yields at `limit`.
inline Vec3 yield(const Vec3& spring, const Vec3& damping, double limit, Vec3& kept) {
  const double stretched = length(spring);
  const bool slides = stretched > limit;
  kept = slides ? (limit / stretched) * spring : spring;
  const Vec3 total = slides ? kept : kept + damping;
  const double size = length(total);
  return size > limit ? (limit / size) * total : total;
}

/// Constant moment against a spin; in one step it never does more than stop it.
inline Vec3 constant(const Vec3& spin, double limit, double mobility, double dt) {
  const double rate = length(spin);
  if (!(rate > 0)) return {};
  const double stop = mobility * dt > 0 ? rate / (mobility * dt) : limit;
  return (-std::min(limit, stop) / rate) * spin;
}

}  // namespace rolling

/// in   old      the spring of the last step [N m], and the stiffness it had (0: none)
/// in   dt       step of the run [s]     in  spring_dt  dt, or 0 to leave the spring as it is
inline RollingMoment rolling_moment(const PairLaw& law, const RollingState& s, const Vec3& old, double old_stiffness, double dt,
                                    double spring_dt) {
  RollingMoment result;
  const double roll_limit = law.rolling_friction * s.radius * s.normal_force;
  const double twist_limit = law.torsional_friction * s.radius * s.normal_force;
  const double twist_rate = dot(s.relative_spin, s.n);
  const Vec3 twist = twist_rate * s.n, roll = s.relative_spin - twist;
  if (!law.rolling_spring) {
    result.moment = rolling::constant(roll, roll_limit, s.spin_mobility, dt) + rolling::constant(twist, twist_limit, s.spin_mobility, dt);
    return result;
  }
  result.stiffness = law.tangential_ratio * s.normal_force / s.overlap * s.radius * s.radius;
  // as a friction spring: give back in proportion when unloaded, create nothing when loaded
  Vec3 spring = old;
  if (result.stiffness < old_stiffness) spring *= result.stiffness / old_stiffness;
  spring -= (result.stiffness * spring_dt) * s.relative_spin;
  const Vec3 spring_twist = dot(spring, s.n) * s.n;
  const double c = s.damping * s.normal_force * s.radius * s.radius;
  Vec3 kept_roll, kept_twist;
  result.moment = rolling::yield(spring - spring_twist, -c * roll, roll_limit, kept_roll);
  result.moment += rolling::yield(spring_twist, -c * twist, twist_limit, kept_twist);
  result.spring = kept_roll + kept_twist;
  return result;
}

}  // namespace scree
