#include "solver/bodies/fluid.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/numbers.hpp"
#include "solver/built_with.hpp"

namespace scree {

namespace {

/// (1 - exp(-z)) / z, z > 0: the mean of exp(-z s) over s from 0 to 1.
double mean_decay(double z) { return -std::expm1(-z) / z; }

/// Torque over that of a slow spin.
double over_slow_spin(double reynolds) { return std::max(1.0, (12.9 * std::sqrt(reynolds) + 128.4) / (64 * kPi)); }

}  // namespace

double DragCoefficients::over_stokes(double reynolds) const {
  if (!(reynolds > 0)) return 1;
  return 1 + a * std::pow(reynolds, b) + c / 24 * reynolds * reynolds / (reynolds + d);
}

DragCoefficients drag_of_ball() { return {0.1806, 0.6459, 0.4251, 6880.95}; }

DragCoefficients drag_of_sphericity(double sphericity) {
  const double f = sphericity;
  return {std::exp(2.3288 - 6.4581 * f + 2.4486 * f * f), 0.0964 + 0.5565 * f,
          std::exp(4.905 - 13.8944 * f + 18.4222 * f * f - 10.2599 * f * f * f),
          std::exp(1.4681 + 12.2584 * f - 20.7322 * f * f + 15.8855 * f * f * f)};
}

FluidForces::FluidForces(const Scene& scene) : scene_(&scene), fluid_(scene.settings.fluid.value()), stokes_(fluid_.drag == Drag::stokes) {
  for (const Material& m : scene.materials) density_ratio_.push_back(fluid_.density / m.density);
  for (const Shape& shape : scene.shapes) {
    diameter_.push_back(shape.equivalent_diameter());
    DragCoefficients drag;
    if (!stokes_ && shape.kind == ShapeKind::sphere) drag = drag_of_ball();
    if (!stokes_ && shape.kind == ShapeKind::solid)
      drag = drag_of_sphericity(std::min(1.0, kPi * diameter_.back() * diameter_.back() / shape.area));
    drag_.push_back(drag);
  }
}

void FluidForces::add_buoyancy(ParticleSet& p) const {
  const Vec3 gravity = scene_->settings.gravity;
  for_each_awake_row(p, [&](std::size_t i) { p.force[i] -= displaced_mass(p, i) * gravity; });
}

void FluidForces::kick(ParticleSet& p, double h) const {
  for_each_awake_row(p, [&](std::size_t i) { kick_body(p, i, h); });
}

void FluidForces::kick_body(ParticleSet& p, std::size_t i, double h) const {
  if (p.fixed[i] || !(h > 0)) return;
  const double d = diameter(p.shape[i], p.scale[i]), m = p.mass[i];
  const DragCoefficients& law = drag_[static_cast<std::size_t>(p.shape[i])];

  const double slow = 3 * kPi * fluid_.viscosity * d * p.inverse_mass[i], reynolds = fluid_.density * d / fluid_.viscosity;
  const Vec3 a = p.inverse_mass[i] * p.force[i], u = p.v[i] - fluid_.velocity;
  const auto rate = [&](const Vec3& against) { return stokes_ ? slow : slow * law.over_stokes(reynolds * length(against)); };
  const auto change = [&](double k) { return h * mean_decay(k * h) * (a - k * u); };
  double k = rate(u);
  if (!stokes_) k = std::sqrt(k * rate(u + change(k)));
  const Vec3 dv = change(k);
  // what is left of the impulse when that of the force is taken away did this work
  p.dissipated[i] -= m * dot(dv - h * a, p.v[i] + 0.5 * dv);
  p.v[i] += dv;

  if (!built_with::kRotation || p.lock_rotation[i]) return;
  // in principal axes each component decays by itself
  const bool turns = p.isotropic[i] == 0;
  const Vec3 inverse = p.inverse_inertia[i];
  const Vec3 l = turns ? rotate_inverse(p.q[i], p.L[i]) : p.L[i], t = turns ? rotate_inverse(p.q[i], p.torque[i]) : p.torque[i];
  const auto spin_of = [&inverse](const Vec3& momentum) {
    return Vec3{inverse.x * momentum.x, inverse.y * momentum.y, inverse.z * momentum.z};
  };
  const double slow_spin = kPi * fluid_.viscosity * d * d * d, spin_reynolds = reynolds * d;
  const auto moment = [&](const Vec3& w) { return stokes_ ? slow_spin : slow_spin * over_slow_spin(spin_reynolds * length(w)); };
  const auto momentum_change = [&](double c) {
    Vec3 dl;
    for (int axis = 0; axis < 3; ++axis) {
      const double of_axis = c * inverse[axis];
      dl[axis] = h * mean_decay(of_axis * h) * (t[axis] - of_axis * l[axis]);
    }
    return dl;
  };
  const Vec3 w = spin_of(l);
  double c = moment(w);
  if (!stokes_) c = std::sqrt(c * moment(spin_of(l + momentum_change(c))));
  const Vec3 dl = momentum_change(c), w_after = spin_of(l + dl);
  p.dissipated[i] -= dot(dl - h * t, 0.5 * (w + w_after));
  p.L[i] = turns ? rotate(p.q[i], l + dl) : l + dl;
  p.w[i] = turns ? rotate(p.q[i], w_after) : w_after;
}

double FluidForces::reynolds_number(const BodyKind& body, double speed) const {
  return fluid_.density * speed * diameter(body.shape, body.scale) / fluid_.viscosity;
}

double FluidForces::weight(const BodyKind& body) const {
  const double ratio = density_ratio_[static_cast<std::size_t>(body.material)];
  return scene_->mass(body.shape, body.material, body.scale) * std::abs(1 - ratio) * length(scene_->settings.gravity);
}

double FluidForces::terminal_speed(const BodyKind& body) const {
  const double d = diameter(body.shape, body.scale);
  const double pull = weight(body), slow = 3 * kPi * fluid_.viscosity * d;
  const DragCoefficients& law = drag_[static_cast<std::size_t>(body.shape)];
  // no drag is below Stokes', so the speed is not above his; halving finds it to the last bit or two
  double low = 0, high = pull / slow;
  if (stokes_) return high;
  constexpr int kHalvings = 60;
  for (int n = 0; n < kHalvings; ++n) {
    const double middle = 0.5 * (low + high);
    (slow * middle * law.over_stokes(reynolds_number(body, middle)) < pull ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace scree
