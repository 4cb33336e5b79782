#include "solver/motion.hpp"

#include "solver/built_with.hpp"

namespace scree {

namespace {

Vec3 scaled(const Vec3& by, const Vec3& v) { return {by.x * v.x, by.y * v.y, by.z * v.z}; }

/// Euler's equations without torque: d/dt of the body angular velocity.
Vec3 spin_rate(const Vec3& inertia, const Vec3& inverse_inertia, const Vec3& w) {
  return scaled(inverse_inertia, cross(scaled(inertia, w), w));
}

// Rotation by `angle` about a principal axis: q turns, and the angular momentum seen from the body turns back.
template <int Axis>
void turn(double angle, Quat& q, Vec3& l) {
  const double c = std::cos(0.5 * angle), s = std::sin(0.5 * angle);
  const Quat e{c, Axis == 0 ? s : 0.0, Axis == 1 ? s : 0.0, Axis == 2 ? s : 0.0};
  q = q * e;
  l = rotate(conjugate(e), l);
}

// Free rotors of bodies that are not isotropic. Each takes q and the world angular momentum L over h.

struct DlmRotor {
  static void advance(const Vec3&, const Vec3& inverse_inertia, double h, Vec3& L, Quat& q) {
    Vec3 l = rotate_inverse(q, L);
    turn<2>(0.5 * h * l.z * inverse_inertia.z, q, l);
    turn<1>(0.5 * h * l.y * inverse_inertia.y, q, l);
    turn<0>(h * l.x * inverse_inertia.x, q, l);
    turn<1>(0.5 * h * l.y * inverse_inertia.y, q, l);
    turn<2>(0.5 * h * l.z * inverse_inertia.z, q, l);
    q = normalised(q);
  }
};

struct MidpointRotor {
  static void advance(const Vec3&, const Vec3& inverse_inertia, double h, Vec3& L, Quat& q) {
    // The fixed point contracts by about |w| h, at most 0.1 by the step limit of spin: 16 digits in 16 rounds.
    constexpr int kMostRounds = 40;
    constexpr double kConverged = 1e-16;  // of the momentum: rounding
    const Vec3 start = rotate_inverse(q, L);
    Vec3 middle = start;
    for (int round = 0; round < kMostRounds; ++round) {
      const Vec3 next = rotate_inverse(rotation_by((0.5 * h) * scaled(inverse_inertia, middle)), start);
      const bool done = squared_length(next - middle) <= kConverged * kConverged * squared_length(start);
      middle = next;
      if (done) break;
    }
    q = normalised(q * rotation_by(h * scaled(inverse_inertia, middle)));
  }
};

struct RigRotor {
  static void advance(const Vec3& inertia, const Vec3& inverse_inertia, double h, Vec3& L, Quat& q) {
    const Vec3 l = rotate_inverse(q, L), w = scaled(inverse_inertia, l);
    const Quat half = rotation_by((0.5 * h) * w);
    const Vec3 predicted = scaled(inverse_inertia, rotate_inverse(half, l));
    const Vec3 next = w + h * spin_rate(inertia, inverse_inertia, predicted);
    q = normalised(q * half * rotation_by((0.5 * h) * next));
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
  static void advance(const Vec3& inertia, const Vec3& inverse_inertia, double h, Vec3& L, Quat& q) {
    const Vec3 w = scaled(inverse_inertia, rotate_inverse(q, L));
    const Vec3 middle = runge_kutta(inertia, inverse_inertia, 0.5 * h, w), next = runge_kutta(inertia, inverse_inertia, h, w);
    q = normalised(q * rotation_by(h * middle));
    L = rotate(q, scaled(inertia, next));
  }
};

struct EulerRotor {
  static void advance(const Vec3& inertia, const Vec3& inverse_inertia, double h, Vec3& L, Quat& q) {
    const Vec3 w = scaled(inverse_inertia, rotate_inverse(q, L));
    q = normalised(q * rotation_by(h * w));
    L = rotate(q, scaled(inertia, w + h * spin_rate(inertia, inverse_inertia, w)));
  }
};

template <class Rotor>
void rotate_by(const Vec3& inertia, const Vec3& inverse_inertia, bool isotropic, double h, Vec3& L, Quat& q, Vec3& w) {
  if (isotropic) {  // w is constant: one exact rotation about it
    w = inverse_inertia.x * L;
    const double rate = length(w);
    if (rate > 0) q = normalised(quaternion_of((1 / rate) * w, rate * h) * q);
    return;
  }
  Rotor::advance(inertia, inverse_inertia, h, L, q);
  w = angular_velocity(q, inverse_inertia, L);
}

void kick(ParticleSet& p, double h) {
  const auto count = static_cast<std::ptrdiff_t>(p.owned);
#pragma omp parallel for schedule(static)
  for (std::ptrdiff_t k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    if (p.fixed[i]) continue;
    p.v[i] += (h * p.inverse_mass[i]) * p.force[i];
    if (!built_with::kRotation || p.lock_rotation[i]) continue;
    p.L[i] += h * p.torque[i];
    p.w[i] = angular_velocity(p.q[i], p.inverse_inertia[i], p.L[i]);
  }
}

template <class Rotor>
void drift(ParticleSet& p, double h) {
  const auto count = static_cast<std::ptrdiff_t>(p.owned);
#pragma omp parallel for schedule(static)
  for (std::ptrdiff_t k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    if (p.fixed[i]) continue;
    p.x[i] += h * p.v[i];
    if (built_with::kRotation && !p.lock_rotation[i]) {
      rotate_by<Rotor>(p.inertia[i], p.inverse_inertia[i], p.isotropic[i] != 0, h, p.L[i], p.q[i], p.w[i]);
    }
  }
}

}  // namespace

Integrator integrator_of(const std::string& name) {
  if (name == "kdk-dlm") return Integrator::kdk_dlm;
  if (name == "rig") return Integrator::rig;
  if (name == "spiral") return Integrator::spiral;
  if (name == "midpoint") return Integrator::midpoint;
  if (name == "euler") return Integrator::euler;
  throw InputError("motion.integrator = \"{}\"; expected kdk-dlm, rig, spiral, midpoint or euler", name);
}

void begin_step(Integrator integrator, ParticleSet& p, double h) {
  if (integrator == Integrator::euler) {
    drift<EulerRotor>(p, h);
    kick(p, h);
    return;
  }
  kick(p, 0.5 * h);
  switch (integrator) {
    case Integrator::kdk_dlm: return drift<DlmRotor>(p, h);
    case Integrator::midpoint: return drift<MidpointRotor>(p, h);
    case Integrator::rig: return drift<RigRotor>(p, h);
    case Integrator::spiral: return drift<SpiralRotor>(p, h);
    case Integrator::euler: return;
  }
}

void end_step(Integrator integrator, ParticleSet& p, double h) {
  if (integrator != Integrator::euler) kick(p, 0.5 * h);
}

void rotate_freely(Integrator integrator, const Vec3& inertia, const Vec3& inverse_inertia, bool isotropic, double h, Vec3& L,
                   Quat& q, Vec3& w) {
  switch (integrator) {
    case Integrator::kdk_dlm: return rotate_by<DlmRotor>(inertia, inverse_inertia, isotropic, h, L, q, w);
    case Integrator::midpoint: return rotate_by<MidpointRotor>(inertia, inverse_inertia, isotropic, h, L, q, w);
    case Integrator::rig: return rotate_by<RigRotor>(inertia, inverse_inertia, isotropic, h, L, q, w);
    case Integrator::spiral: return rotate_by<SpiralRotor>(inertia, inverse_inertia, isotropic, h, L, q, w);
    case Integrator::euler: return rotate_by<EulerRotor>(inertia, inverse_inertia, isotropic, h, L, q, w);
  }
}

Quat rotation_by(const Vec3& theta) {
  const double angle = length(theta);
  // Below the square root of the smallest double the squares in length() vanish, and sin(a/2) = a/2 exactly.
  if (!(angle > 1e-150)) return {1, 0.5 * theta.x, 0.5 * theta.y, 0.5 * theta.z};
  return quaternion_of((1 / angle) * theta, angle);
}

double translational_energy(const ParticleSet& p, std::size_t i) {
  return p.fixed[i] ? 0.0 : 0.5 * p.mass[i] * squared_length(p.v[i]);
}

double rotational_energy(const ParticleSet& p, std::size_t i) {
  if (p.fixed[i] || p.lock_rotation[i]) return 0;
  const Vec3 l = rotate_inverse(p.q[i], p.L[i]);
  return 0.5 * (l.x * l.x * p.inverse_inertia[i].x + l.y * l.y * p.inverse_inertia[i].y + l.z * l.z * p.inverse_inertia[i].z);
}

}  // namespace scree
