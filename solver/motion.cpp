#include "solver/motion.hpp"

namespace scree {

void kick(ParticleSet& p, double h) {
  const auto count = static_cast<std::ptrdiff_t>(p.owned);
#pragma omp parallel for schedule(static)
  for (std::ptrdiff_t k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    if (p.fixed[i]) continue;
    p.v[i] += (h * p.inverse_mass[i]) * p.force[i];
    if (p.lock_rotation[i]) continue;
    p.L[i] += h * p.torque[i];
    p.w[i] = angular_velocity(p.q[i], p.inverse_inertia[i], p.L[i]);
  }
}

namespace {

// Rotation by `angle` about a principal axis: q turns, and the angular momentum seen from the body turns back.
template <int Axis>
void turn(double angle, Quat& q, Vec3& l) {
  const double c = std::cos(0.5 * angle), s = std::sin(0.5 * angle);
  const Quat e{c, Axis == 0 ? s : 0.0, Axis == 1 ? s : 0.0, Axis == 2 ? s : 0.0};
  q = q * e;
  l = rotate(conjugate(e), l);
}

}  // namespace

void rotate_freely(const Vec3& inverse_inertia, bool isotropic, double h, const Vec3& L, Quat& q, Vec3& w) {
  if (isotropic) {  // w is constant: one exact rotation about it
    w = inverse_inertia.x * L;
    const double rate = length(w);
    if (rate > 0) q = normalised(quaternion_of((1 / rate) * w, rate * h) * q);
    return;
  }
  Vec3 l = rotate_inverse(q, L);
  turn<2>(0.5 * h * l.z * inverse_inertia.z, q, l);
  turn<1>(0.5 * h * l.y * inverse_inertia.y, q, l);
  turn<0>(h * l.x * inverse_inertia.x, q, l);
  turn<1>(0.5 * h * l.y * inverse_inertia.y, q, l);
  turn<2>(0.5 * h * l.z * inverse_inertia.z, q, l);
  q = normalised(q);
  w = angular_velocity(q, inverse_inertia, L);
}

void drift(ParticleSet& p, double h) {
  const auto count = static_cast<std::ptrdiff_t>(p.owned);
#pragma omp parallel for schedule(static)
  for (std::ptrdiff_t k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    if (p.fixed[i]) continue;
    p.x[i] += h * p.v[i];
    if (!p.lock_rotation[i]) rotate_freely(p.inverse_inertia[i], p.isotropic[i] != 0, h, p.L[i], p.q[i], p.w[i]);
  }
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
