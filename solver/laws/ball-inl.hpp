// The contact of a ball with a ball, a plane or a cylinder, in world axes, for one pair or for a pair in each lane: see laws/real.hpp.
//
// A ball looks the same however it is turned, so that nothing of such a contact depends on a frame of A: its spring is kept in world axes.
// Velocities are those of half a step before, positions those of now. What the surfaces do is taken at the normal of half a step before:
// arms of now would give slip to bodies that turn about one axis and stick together.
// Source of the law: docs/reference/contact-law.md sections 3.2 to 3.4.

/// How two surfaces meet.
struct BallMeeting {
  Real3 n;              ///< from B to A, unit
  Real3 velocity;       ///< of A's centre against B's, or against what of a wall would be there [m/s]
  Real3 arm;            ///< the surfaces slide by velocity - arm x n [m/s]
  Real3 spins;          ///< of both bodies, their sum [rad/s]
  Real3 relative_spin;  ///< of A against B [rad/s]; used by rolling alone
  Real3 turn;           ///< change of n in half a step
  Real vn;              ///< at which they part [m/s]
  Real overlap;         ///< [m]
  Real distance;        ///< of the frames of A and B, with which the overlap is rounded [m]
};

/// How two balls move against each other.
struct BallsApart {
  Real3 between;        ///< from the centre of B to that of A [m]
  Real3 velocity;       ///< of A's centre against B's [m/s]
  Real3 spins;          ///< w_a + w_b [rad/s]
  Real3 surface_spins;  ///< R_a w_a + R_b w_b [m/s]
  Real3 relative_spin;  ///< w_a - w_b [rad/s]
};

/// in   half      half of the overlap without margins: the contact point lies so deep in either [m]
/// in   half_step  of springs [s]; 0 where they do not move
SCREE_LAW BallMeeting meeting_of(const BallsApart& balls, Real distance, Real overlap, Real half, Real half_step) {
  const Real inverse = Real(1.0) / distance;
  const Real3 n = inverse * balls.between;
  const Real vn = dot(balls.velocity, n);
  return {n,
          balls.velocity,
          balls.surface_spins - half * balls.spins,
          balls.spins,
          balls.relative_spin,
          (half_step * inverse) * (balls.velocity - vn * n),
          vn,
          overlap,
          distance};
}

/// A plane or cylinder as a ball meets it.
struct WallBeside {
  Real3 n;           ///< at the ball, towards its centre
  Real3 axis;        ///< of a cylinder
  Real curvature;    ///< 1 over the distance of the ball from the axis [1/m]; 0: a plane
  Real3 from_pivot;  ///< from a point of the wall, whose velocity is known, to the centre of the ball [m]
  Real3 pivot_v, w;  ///< of that point [m/s], of the wall [rad/s]
  Real distance;     ///< of the frames of both [m]
};

/// in   v, w, reach   of the ball; from its centre to the contact point [m]
SCREE_LAW BallMeeting meeting_of(const WallBeside& wall, const Real3& v, const Real3& w, Real reach, Real overlap, Real half_step) {
  const Real3 turning = cross(wall.w, wall.from_pivot), velocity = v - wall.pivot_v - turning;
  const Real vn = dot(velocity, wall.n);
  const Real3 sliding = velocity - vn * wall.n, around = sliding - dot(sliding, wall.axis) * wall.axis;
  return {wall.n,
          velocity + half_step * cross(wall.w, turning),  // from_pivot is that of now, the velocity of the ball that of before
          reach * (w - wall.w),
          w + wall.w,
          w - wall.w,
          half_step * cross(wall.w, wall.n) - (half_step * wall.curvature) * around,
          vn,
          overlap,
          wall.distance};
}

/// At which the surfaces slide, across n [m/s].
SCREE_LAW Real3 slip_of(const BallMeeting& m) {
  const Real3 before = m.velocity - cross(m.arm, m.n - m.turn);
  const Real along = dot(before, m.n);
  return (before - along * m.n) + along * m.turn;
}

/// Takes the spring of the last step along: it turns about n with the mean of both bodies, and from the last normal to the present one by
/// the shortest rotation, n + n' = 2 (n - turn) but for what is of third order. Its length stays: to rounding for turns below 3e-9 in a
/// step, of which a bed at rest has none, by its own root beyond.
SCREE_LAW Real3 taken_along(const BallMeeting& m, const Real3& s, Real half_step) {
  constexpr double kTurned = 1e-17, kTwisted = 1e-5;  // squares; beyond, a step would change the length by more than rounding
  const Real one(1.0), zero(0.0), twist = half_step * dot(m.spins, m.n), twist2 = twist * twist;
  const Real3 twisted =
      s + (twist * (one - twist2 * Real(1.0 / 6))) * cross(m.n, s) - (Real(0.5) * twist2 * (one - twist2 * Real(1.0 / 12))) * s;
  const Real out = dot(twisted, m.n), lost = out * out, size = dot(s, s);
  Real3 next = twisted - out * (m.n - m.turn);
  if (const Truth turned = (lost > Real(kTurned) * size) | (twist2 > Real(kTwisted)); any(turned)) {
    const Real flat = dot(next, next);
    next = select(turned & (flat > zero), sqrt(size / flat), one) * next;
  }
  return next;
}

/// Half of a turn by the mean of both spins in a step, exact in its axis, to third order in its angle.
SCREE_LAW HalfTurn mean_turn(const Real3& spins, Real half_step) {
  const Real one(1.0);
  const Real3 t = (Real(0.5) * half_step) * spins;
  const Real w = one / sqrt(one + dot(t, t));
  return {w * t, w};
}

/// What damping makes of the push of a ball: in proportion to the speed, on its own.
struct BallDamping {
  Real damping;       ///< [N s/m], divided by `lagged`
  Real rate, lagged;  ///< as laws/damping.hpp
};

/// Viscous.   in   factor   2 zeta over sqrt(2 U / (F D))     in   secant   F / D [N/m]     in   mobility, mass   1/m* and m*
SCREE_LAW BallDamping viscous_damping(Real factor, Real secant, Real mobility, Real mass, Real step) {
  const Real coefficient = factor * sqrt(secant * mobility), rate = coefficient * step, lagged = lag_of(rate);
  return {coefficient * mass / lagged, rate, lagged};
}

/// The push with its damping [N], never below 0.   in   weight   of the damping
SCREE_LAW Real damped_by(Real push, Real damping, Real weight, Real vn) {
  const Real damped = push - damping * weight * vn, zero(0.0);
  return select(zero < damped, damped, zero);
}

/// The torque on a ball about its centre, of what acts across n.
/// in   moment   n x tangential force [N m / m]     in  radius   of the ball     in  half   as above
SCREE_LAW Real3 ball_torque(const Real3& moment, Real radius, Real half) { return (half - radius) * moment; }
