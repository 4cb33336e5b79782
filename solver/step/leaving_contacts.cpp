#include "solver/step/leaving_contacts.hpp"

#include <unordered_set>

namespace scree {

namespace {

/// Work on a body, in half a step, of forces that come from a potential: of all less those of damping and friction [J].
double work_on(const ParticleSet& p, std::int32_t row, double dt, const Vec3& force, const Vec3& torque) {
  const auto i = static_cast<std::size_t>(row);
  return 0.5 * dt * (dot(force, p.v[i]) + dot(torque, p.w[i]));
}

/// The same on a wall that moves.
double work_on_wall(const RunState& s, const BodyPair& pair, double dt, const Vec3& force_a, const Vec3& torque_a) {
  const WallState& wall = s.walls[static_cast<std::size_t>(s.scene.zones()[static_cast<std::size_t>(pair.key.zone)].wall)];
  const Vec3 lever = s.particles.x[static_cast<std::size_t>(pair.a)] - wall.position;
  return -0.5 * dt * (dot(force_a, wall.velocity) + dot(cross(lever, force_a) + torque_a, wall.angular_velocity));
}

}  // namespace

void count_contacts_of_leaving(RunState& s, const std::vector<std::uint8_t>& leaves) {
  // the rank that counts a pair may not own the body that leaves: all ranks are told of all
  std::vector<std::int64_t> mine;
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    if (leaves[i] != 0) mine.push_back(s.particles.id[i]);
  }
  const std::vector<std::int64_t> of_all = s.comm.of_all(mine);
  const std::unordered_set<std::int64_t> all(of_all.begin(), of_all.end());
  // What the last forces have stored, less what they gave to bodies in the first kick of this step: bodies leave between both.
  const ParticleSet& p = s.particles;
  ExactSum& energy = s.totals.departed.energy;
  for (std::size_t k = 0; k < s.pairs.pairs().size(); ++k) {
    const BodyPair& pair = s.pairs.pairs()[k];
    const PairResult& r = s.pairs.results()[k];
    if (!r.active || !(all.contains(pair.key.a) || (pair.b >= 0 && all.contains(pair.key.b)))) continue;
    const Vec3 force = r.force_a - r.dissipative_force_a, torque_a = r.torque_a - r.dissipative_torque_a;
    if (counts_here(pair, p)) {
      energy.add(r.elastic);
      energy.add(-work_on(p, pair.a, s.clock.dt, force, torque_a));
      if (pair.b < 0) energy.add(-work_on_wall(s, pair, s.clock.dt, force, torque_a));
    }
    if (pair.b >= 0 && static_cast<std::size_t>(pair.b) < p.owned)  // each rank knows the velocities of its own
      energy.add(-work_on(p, pair.b, s.clock.dt, -force, r.torque_b - r.dissipative_torque_b));
  }
}

}  // namespace scree
