#include "solver/effects/heat/contact_losses.hpp"

#include "solver/laws/friction.hpp"

namespace scree {

double contact_loss(const RunState& s, std::size_t k, double dt) {
  const ParticleSet& p = s.particles;
  const BodyPair& pair = s.pairs.pairs()[k];
  const PairResult& r = s.pairs.results()[k];
  const auto a = static_cast<std::size_t>(pair.a);
  double power = dot(r.dissipative_force_a, p.v[a]) + dot(r.dissipative_torque_a, p.w[a]);
  if (pair.b >= 0) {
    const auto b = static_cast<std::size_t>(pair.b);
    power += dot(r.dissipative_torque_b, p.w[b]) - dot(r.dissipative_force_a, p.v[b]);
  } else {
    // about the wall's own point, as in add_wall_effects()
    const WallState& wall = s.walls[static_cast<std::size_t>(s.scene.zones()[static_cast<std::size_t>(pair.key.zone)].wall)];
    const Vec3 force = -r.dissipative_force_a, torque = cross(p.x[a] - wall.position, force) - r.dissipative_torque_a;
    power += dot(force, wall.velocity) + dot(torque, wall.angular_velocity) - r.surface_power;
  }
  return -dt * power;
}

double stored_in_springs(const BodyPair& pair) {
  double stored = 0;
  for (const FrictionSpring& spring : pair.state.springs) {
    // a stiffness below 0 marks one that slides
    if (is_spring(spring)) stored = with_energy({spring.force, spring.stiffness}, stored);
  }
  return stored;
}

}  // namespace scree
