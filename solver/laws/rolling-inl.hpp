// The elastic-plastic moment of rolling and torsional resistance (laws/rolling.hpp, type C), for one pair or for a pair in each lane: see
// laws/real.hpp.

/// What the pair is at this step.
struct RollingState {
  Real3 n;                       ///< mean contact normal, unit
  Real3 relative_spin;           ///< of A against B [rad/s]
  Real normal_force;             ///< N [N], elastic
  Real overlap;                  ///< D [m]
  Real radius;                   ///< R* [m]
  Real damping;                  ///< tangential damping over normal force [s/m]
  Real roll_limit, twist_limit;  ///< largest moments across and along n [N m]
  Real tangential_ratio;         ///< as PairLaw
};

/// Moment on A and its spring, both with the part along n and the part across it in one vector.
struct RollingMoment {
  Real3 moment;    ///< on A [N m]
  Real3 spring;    ///< elastic part, to be kept [N m]
  Real stiffness;  ///< [N m/rad]
};

/// One of the two parts: yields at `limit`.
SCREE_LAW Real3 yielded(const Real3& spring, const Real3& damping, Real limit, Real3& kept) {
  const Real stretched = length(spring);
  const Truth slides = stretched > limit;
  kept = select(slides, (limit / stretched) * spring, spring);
  const Real3 total = select(slides, kept, kept + damping);
  const Real size = length(total);
  return select(size > limit, (limit / size) * total, total);
}

/// in   old      the spring of the last step [N m], and the stiffness that it had (0: none)
/// in   step     by which the spring moves [s]; 0 leaves it as it is
SCREE_LAW RollingMoment rolling_spring(const RollingState& s, const Real3& old, Real old_stiffness, Real step) {
  RollingMoment result;
  const Real3 twist = dot(s.relative_spin, s.n) * s.n, roll = s.relative_spin - twist;
  result.stiffness = s.tangential_ratio * s.normal_force / s.overlap * s.radius * s.radius;
  // as a friction spring: give back in proportion when unloaded, create nothing when loaded
  Real3 spring = select(result.stiffness < old_stiffness, result.stiffness / old_stiffness, Real(1.0)) * old;
  spring = spring - (result.stiffness * step) * s.relative_spin;
  const Real3 spring_twist = dot(spring, s.n) * s.n;
  const Real c = s.damping * s.normal_force * s.radius * s.radius;
  Real3 kept_roll, kept_twist;
  result.moment = yielded(spring - spring_twist, (-c) * roll, s.roll_limit, kept_roll);
  result.moment = result.moment + yielded(spring_twist, (-c) * twist, s.twist_limit, kept_twist);
  result.spring = kept_roll + kept_twist;
  return result;
}
