#include "solver/bodies/motion.hpp"

#include <algorithm>
#include <limits>
#include <type_traits>

#include "solver/bodies/fluid.hpp"
#include "solver/bodies/motion_lanes.hpp"
#include "solver/bodies/sine_cosine.hpp"
#include "solver/built_with.hpp"

namespace scree {

namespace {

Vec3 scaled(const Vec3& by, const Vec3& v) { return {by.x * v.x, by.y * v.y, by.z * v.z}; }

/// Euler's equations without torque: d/dt of the body angular velocity.
Vec3 spin_rate(const Vec3& inertia, const Vec3& inverse_inertia, const Vec3& w) {
  return scaled(inverse_inertia, cross(scaled(inertia, w), w));
}

/// As quaternion_of(), of the turn in a step.
Quat turn_about(const Vec3& axis, double angle) {
  double sine, cosine;
  sine_and_cosine(0.5 * angle, sine, cosine);
  return {cosine, sine * axis.x, sine * axis.y, sine * axis.z};
}

// Rotation by `angle` about a principal axis i, with j and k after it: q turns, and the angular momentum seen from the body
// turns back.
template <double Quat::*I, double Quat::*J, double Quat::*K>
void turn(double angle, Quat& q, double& lj, double& lk) {
  double s, c;
  sine_and_cosine(0.5 * angle, s, c);
  const double w = q.w, i = q.*I, j = q.*J, k = q.*K;
  q.w = c * w - s * i;
  q.*I = c * i + s * w;
  q.*J = c * j + s * k;
  q.*K = c * k - s * j;
  const double cosine = 1 - 2 * s * s, sine = 2 * s * c, old = lj;
  lj = cosine * lj + sine * lk;
  lk = cosine * lk - sine * old;
}
void turn_x(double angle, Quat& q, Vec3& l) { turn<&Quat::x, &Quat::y, &Quat::z>(angle, q, l.y, l.z); }
void turn_y(double angle, Quat& q, Vec3& l) { turn<&Quat::y, &Quat::z, &Quat::x>(angle, q, l.z, l.x); }
void turn_z(double angle, Quat& q, Vec3& l) { turn<&Quat::z, &Quat::x, &Quat::y>(angle, q, l.x, l.y); }

// x and q remember what rounding took from them. Without that a body that goes less than half a unit in the last place a step
// stands still, and gains speed until it jumps by a whole one: at stiff contacts that is no true rest.

/// x + way, and what rounding takes from the sum for the next time.
/// Source: the error of a sum, exactly: Knuth, The Art of Computer Programming 2 (1969), section 4.2.2, theorem B.
void advance(double& x, double& remainder, double way) {
  way += remainder;
  const double sum = x + way, added = sum - x;
  remainder = (x - (sum - added)) + (way - added);
  x = sum;
}
void advance(Vec3& x, Vec3& remainder, const Vec3& way) {
  advance(x.x, remainder.x, way.x);
  advance(x.y, remainder.y, way.y);
  advance(x.z, remainder.z, way.z);
}
void advance(Quat& q, Quat& remainder, const Quat& way) {
  advance(q.w, remainder.w, way.w);
  advance(q.x, remainder.x, way.x);
  advance(q.y, remainder.y, way.y);
  advance(q.z, remainder.z, way.z);
}
/// After a rotation: back to a unit quaternion, once it is off by more than rounding. The sum of its squares is known to 2.5 epsilon, so
/// a body at rest is left alone.
void keep_unit(Quat& q, Quat& remainder) {
  constexpr double kUnitError = 8 * std::numeric_limits<double>::epsilon();
  const double excess = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z - 1, by = -0.5 * excess;
  if (std::abs(excess) > kUnitError) advance(q, remainder, {by * q.w, by * q.x, by * q.y, by * q.z});
}

/// q after what a rotation adds to it.
void add_turn(Quat& q, Quat& remainder, const Quat& way) {
  advance(q, remainder, way);
  keep_unit(q, remainder);
}
/// q after the rotation `by`, whose axis is given in the body. What is added is small where `by` is.
void turn_in_body(Quat& q, Quat& remainder, const Quat& by) { add_turn(q, remainder, q * Quat{by.w - 1, by.x, by.y, by.z}); }

// Free rotors of bodies that are not isotropic. Each takes q with its remainder, and the world angular momentum L, over h.

struct DlmRotor {
  static void advance(const Vec3&, const Vec3& inverse_inertia, double h, Vec3& L, Quat& q, Quat& remainder) {
    Vec3 l = rotate_inverse(q, L);
    Quat by;
    turn_z(0.5 * h * l.z * inverse_inertia.z, by, l);
    turn_y(0.5 * h * l.y * inverse_inertia.y, by, l);
    turn_x(h * l.x * inverse_inertia.x, by, l);
    turn_y(0.5 * h * l.y * inverse_inertia.y, by, l);
    turn_z(0.5 * h * l.z * inverse_inertia.z, by, l);
    turn_in_body(q, remainder, by);
  }
};

struct MidpointRotor {
  static void advance(const Vec3&, const Vec3& inverse_inertia, double h, Vec3& L, Quat& q, Quat& remainder) {
    // The fixed point contracts by about |w| h, at most 0.1 by the step limit of spin: 16 digits in 16 rounds.
    constexpr int kMaxRounds = 40;
    constexpr double kConverged = 1e-16;  // of the momentum: rounding
    const Vec3 start = rotate_inverse(q, L);
    Vec3 middle = start;
    for (int round = 0; round < kMaxRounds; ++round) {
      const Vec3 next = rotate_inverse(rotation_by((0.5 * h) * scaled(inverse_inertia, middle)), start);
      const bool done = squared_length(next - middle) <= kConverged * kConverged * squared_length(start);
      middle = next;
      if (done) break;
    }
    turn_in_body(q, remainder, rotation_by(h * scaled(inverse_inertia, middle)));
  }
};

struct RigRotor {
  static void advance(const Vec3& inertia, const Vec3& inverse_inertia, double h, Vec3& L, Quat& q, Quat& remainder) {
    const Vec3 l = rotate_inverse(q, L), w = scaled(inverse_inertia, l);
    const Quat half = rotation_by((0.5 * h) * w);
    const Vec3 predicted = scaled(inverse_inertia, rotate_inverse(half, l));
    const Vec3 next = w + h * spin_rate(inertia, inverse_inertia, predicted);
    turn_in_body(q, remainder, half * rotation_by((0.5 * h) * next));
    L = rotate(q, scaled(inertia, next));
  }
};

struct SpiralRotor {
  static Vec3 runge_kutta(const Vec3& inertia, const Vec3& inverse_inertia, double h, const Vec3& w) {
    const Vec3 k1 = h * spin_rate(inertia, inverse_inertia, w);
    const Vec3 k2 = h * spin_rate(inertia, inverse_inertia, w + k1);
    const Vec3 k3 = h * spin_rate(inertia, inverse_inertia, w + 0.25 * (k1 + k2));
    return w + (1.0 / 6) * (k1 + k2 + 4 * k3);
  }
  static void advance(const Vec3& inertia, const Vec3& inverse_inertia, double h, Vec3& L, Quat& q, Quat& remainder) {
    const Vec3 w = scaled(inverse_inertia, rotate_inverse(q, L));
    const Vec3 middle = runge_kutta(inertia, inverse_inertia, 0.5 * h, w), next = runge_kutta(inertia, inverse_inertia, h, w);
    turn_in_body(q, remainder, rotation_by(h * middle));
    L = rotate(q, scaled(inertia, next));
  }
};

struct EulerRotor {
  static void advance(const Vec3& inertia, const Vec3& inverse_inertia, double h, Vec3& L, Quat& q, Quat& remainder) {
    const Vec3 w = scaled(inverse_inertia, rotate_inverse(q, L));
    turn_in_body(q, remainder, rotation_by(h * w));
    L = rotate(q, scaled(inertia, w + h * spin_rate(inertia, inverse_inertia, w)));
  }
};

template <class Rotor>
void rotate_by(const Vec3& inertia, const Vec3& inverse_inertia, bool isotropic, double h, Vec3& L, Quat& q, Quat& remainder, Vec3& w) {
  if (isotropic) {  // w is constant: one exact rotation about it
    w = inverse_inertia.x * L;
    const double half = 0.5 * h, aa = (half * half) * squared_length(w);
    if (!(aa > 0)) return;
    double ratio, less_one;
    sine_ratio_and_less_one(aa, ratio, less_one);
    const Vec3 axis = (half * ratio) * w;
    add_turn(q, remainder, Quat{less_one, axis.x, axis.y, axis.z} * q);
    return;
  }
  Rotor::advance(inertia, inverse_inertia, h, L, q, remainder);
  w = angular_velocity(q, inverse_inertia, L);
}

void kick_row(ParticleSet& p, double h, std::size_t i) {
  if (p.fixed[i]) return;
  p.v[i] += (h * p.inverse_mass[i]) * p.force[i];
  if (!built_with::kRotation || p.lock_rotation[i]) return;
  p.L[i] += h * p.torque[i];
  p.w[i] = p.isotropic[i] != 0 ? p.inverse_inertia[i].x * p.L[i] : angular_velocity(p.q[i], p.inverse_inertia[i], p.L[i]);
}

void kick(ParticleSet& p, double h) {
#pragma omp parallel
  for_awake_rows_of_thread(p, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = kick_in_lanes(p, h, begin, end); i < end; ++i) kick_row(p, h, i);
  });
}

template <class Rotor>
void kick_and_drift_row(ParticleSet& p, double kick_time, double h, std::size_t i) {
  if (p.fixed[i]) return;
  p.v[i] += (kick_time * p.inverse_mass[i]) * p.force[i];
  advance(p.x[i], p.x_remainder[i], h * p.v[i]);
  if (!built_with::kRotation || p.lock_rotation[i]) return;
  p.L[i] += kick_time * p.torque[i];
  rotate_by<Rotor>(p.inertia[i], p.inverse_inertia[i], p.isotropic[i] != 0, h, p.L[i], p.q[i], p.q_remainder[i], p.w[i]);
}

/// A kick over `kick_time`, then the drift over h: in one pass, since the angular velocity in between is not needed.
template <class Rotor>
void kick_and_drift(ParticleSet& p, double kick_time, double h) {
#pragma omp parallel
  for_awake_rows_of_thread(p, [&](std::size_t begin, std::size_t end) {
    while (begin < end) {
      begin = drift_in_lanes(p, kick_time, h, std::is_same_v<Rotor, DlmRotor>, begin, end);
      for (const std::size_t plain = std::min(end, begin + kMaxDriftLanes); begin < plain; ++begin)
        kick_and_drift_row<Rotor>(p, kick_time, h, begin);
    }
  });
}

}  // namespace

void begin_step(Integrator integrator, ParticleSet& p, double h, const FluidForces* fluid) {
  double kick_time = 0.5 * h;
  if (fluid != nullptr && integrator != Integrator::euler) {
    fluid->kick(p, kick_time);
    kick_time = 0;
  }
  switch (integrator) {
    case Integrator::kdk_dlm:
      return kick_and_drift<DlmRotor>(p, kick_time, h);
    case Integrator::midpoint:
      return kick_and_drift<MidpointRotor>(p, kick_time, h);
    case Integrator::rig:
      return kick_and_drift<RigRotor>(p, kick_time, h);
    case Integrator::spiral:
      return kick_and_drift<SpiralRotor>(p, kick_time, h);
    case Integrator::euler:
      kick_and_drift<EulerRotor>(p, 0, h);
      return fluid != nullptr ? fluid->kick(p, h) : kick(p, h);
  }
}

void end_step(Integrator integrator, ParticleSet& p, double h, const FluidForces* fluid) {
  if (integrator == Integrator::euler) return;
  if (fluid != nullptr)
    fluid->kick(p, 0.5 * h);
  else
    kick(p, 0.5 * h);
}

void rotate_freely(Integrator integrator, const Vec3& inertia, const Vec3& inverse_inertia, bool isotropic, double h, Vec3& L, Quat& q,
                   Quat& remainder, Vec3& w) {
  switch (integrator) {
    case Integrator::kdk_dlm:
      return rotate_by<DlmRotor>(inertia, inverse_inertia, isotropic, h, L, q, remainder, w);
    case Integrator::midpoint:
      return rotate_by<MidpointRotor>(inertia, inverse_inertia, isotropic, h, L, q, remainder, w);
    case Integrator::rig:
      return rotate_by<RigRotor>(inertia, inverse_inertia, isotropic, h, L, q, remainder, w);
    case Integrator::spiral:
      return rotate_by<SpiralRotor>(inertia, inverse_inertia, isotropic, h, L, q, remainder, w);
    case Integrator::euler:
      return rotate_by<EulerRotor>(inertia, inverse_inertia, isotropic, h, L, q, remainder, w);
  }
}

Quat rotation_by(const Vec3& theta) {
  const double angle = length(theta);
  // Below the square root of the smallest double the squares in length() vanish, and sin(a/2) = a/2 exactly.
  if (!(angle > 1e-150)) return {1, 0.5 * theta.x, 0.5 * theta.y, 0.5 * theta.z};
  return turn_about((1 / angle) * theta, angle);
}

double translational_energy(const ParticleSet& p, std::size_t i) { return p.fixed[i] ? 0.0 : 0.5 * p.mass[i] * squared_length(p.v[i]); }

double rotational_energy(const ParticleSet& p, std::size_t i) {
  if (p.fixed[i] || p.lock_rotation[i]) return 0;
  const Vec3 l = rotate_inverse(p.q[i], p.L[i]);
  return 0.5 * (l.x * l.x * p.inverse_inertia[i].x + l.y * l.y * p.inverse_inertia[i].y + l.z * l.z * p.inverse_inertia[i].z);
}

}  // namespace scree
