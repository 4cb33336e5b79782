#include "solver/state/run_state.hpp"

#include <omp.h>

#include <algorithm>
#include <array>

#include "solver/bodies/body_passes.hpp"

namespace scree {

RunState::RunState(const mpi::Communicator& on, const SolverScene& of)
    : comm(on),
      scene(of),
      integrator(of.source().settings.integrator),
      fluid(of.source().settings.fluid ? std::optional<FluidForces>(of.source()) : std::nullopt),
      totals(of.source().walls.size(), of.source().outlets.size(), of.source().inlets.size()) {
  particles.cell = Cell(of.periodicity());
  for (const std::int64_t id : of.source().bodies.id) largest_id = std::max(largest_id, id);
  for (const Wall& wall : of.source().walls) largest_id = std::max(largest_id, wall.id);
  if (!of.source().bonds.empty()) {
    bonds.emplace(of);
    fragments.emplace(of);
  }
  if (of.has_answering_walls()) drives.resize(of.source().walls.size());
}

void RunState::set_walls() {
  walls.clear();
  const std::vector<Wall>& source = scene.source().walls;
  for (std::size_t w = 0; w < source.size(); ++w)
    walls.push_back(wall_state(source[w], clock.time(), clock.dt, w < drives.size() ? &drives[w] : nullptr));
}

double potential_energy(const RunState& s, const ParticleSet& p, std::size_t body) {
  return potential_energy_at(s, p, body, p.cell.periodicity().way_of(p.x[body], p.image[body]));
}

double potential_energy_at(const RunState& s, const ParticleSet& p, std::size_t body, const Vec3& way) {
  if (p.fixed[body]) return 0;
  const double mass = s.fluid ? s.fluid->weighed_mass(p, body) : p.mass[body];
  const double of_gravity = -mass * dot(s.scene.source().settings.gravity, way);
  const BodyForce* given = s.scene.given_force(p.id[body]);
  return given == nullptr ? of_gravity : of_gravity - dot(given->force, way);
}

void finish_in_free_flight(const RunState& s, ParticleSet& p, std::size_t body) {
  if (s.integrator == Integrator::euler || p.fixed[body]) return;
  const Vec3 gravity = s.scene.source().settings.gravity;
  if (const BodyForce* given = s.scene.given_force(p.id[body])) p.v[body] += (0.5 * s.clock.dt * p.inverse_mass[body]) * given->force;
  if (!s.fluid) {
    p.v[body] += (0.5 * s.clock.dt) * gravity;
    return;
  }
  p.force[body] = s.fluid->weighed_mass(p, body) * gravity;
  p.torque[body] = {};
  s.fluid->kick_body(p, body, 0.5 * s.clock.dt);
}

double farthest_from_wall(const RunState& s, std::size_t wall, const Vec3& place) {
  const ParticleSet& p = s.particles;
  double farthest = 0;
  for (std::size_t i = 0; i < p.owned; ++i) {
    if (p.fixed[i] && s.scene.drive(wall) == nullptr) continue;
    farthest = std::max(farthest, length(p.x[i] - place) + p.radius[i]);
  }
  return farthest;
}

double chord_of_turn(const WallState& from, const WallState& to) {
  const Quat turn = conjugate(from.orientation) * to.orientation;
  return 2 * std::sqrt(turn.x * turn.x + turn.y * turn.y + turn.z * turn.z);
}

double walls_moved(const RunState& s, const std::vector<WallState>& from, const std::vector<WallState>& to) {
  if (!s.scene.has_driven_walls()) return 0;
  double moved = 0;
  for (std::size_t k = 0; k < to.size(); ++k) {
    const double chord = chord_of_turn(from[k], to[k]), farthest = chord > 0 ? farthest_from_wall(s, k, to[k].position) : 0;
    moved = std::max(moved, length(to[k].position - from[k].position) + chord * farthest);
  }
  return moved;
}

double fastest_wall(const RunState& s, const std::vector<WallState>& walls) {
  double fastest = 0;
  for (std::size_t k = 0; k < walls.size(); ++k) {
    const WallState& w = walls[k];
    const double spin = length(w.angular_velocity), farthest = spin > 0 ? farthest_from_wall(s, k, w.position) : 0;
    fastest = std::max(fastest, length(w.velocity) + farthest * spin);
  }
  return fastest;
}

double wall_share_of_frequency(const RunState& s, std::size_t wall) {
  if (wall >= s.drives.size()) return 0;
  const Drive* drive = s.scene.drive(wall);
  return drive != nullptr && drive->inertia > 0 ? s.drives[wall].stiffness / drive->inertia : 0;
}

namespace {

/// Impulses of walls, those of a wall added many at a time: pairs of several walls come in turn.
class ImpulsesOfWalls {
 public:
  explicit ImpulsesOfWalls(WallTotals& totals) : totals_(totals), walls_(totals.impulse.size() > kMostWalls ? 0 : totals.impulse.size()) {}
  ImpulsesOfWalls(const ImpulsesOfWalls&) = delete;
  ImpulsesOfWalls& operator=(const ImpulsesOfWalls&) = delete;
  ~ImpulsesOfWalls() {
    for (std::size_t w = 0; w < walls_; ++w) add_up(w);
  }

  void add(std::size_t wall, const Vec3& impulse) {
    if (walls_ == 0) {
      for (int k = 0; k < 3; ++k) totals_.impulse[wall][static_cast<std::size_t>(k)].add(impulse[k]);
      return;
    }
    const std::size_t n = counts_[wall]++;
    for (int k = 0; k < 3; ++k) terms_[wall][static_cast<std::size_t>(k)][n] = impulse[k];
    if (n + 1 == kManyTerms) add_up(wall);
  }

 private:
  void add_up(std::size_t wall) {
    for (std::size_t k = 0; k < 3 && counts_[wall] > 0; ++k) totals_.impulse[wall][k].add_many(terms_[wall][k], counts_[wall]);
    counts_[wall] = 0;
  }

  static constexpr std::size_t kMostWalls = 32;  // 1.5 kB each, on the stack; of more walls, each has few contacts

  WallTotals& totals_;
  std::size_t walls_;  // 0: each impulse for itself
  std::array<std::array<ManyTerms, 3>, kMostWalls> terms_;
  std::array<std::size_t, kMostWalls> counts_{};
};

bool stands_still(const WallState& wall) { return wall.velocity == Vec3{} && wall.angular_velocity == Vec3{}; }

/// What a pair does to a wall that moves, besides its impulse.   in   lever   from the wall to A
void add_work_on(const WallState& wall, const Vec3& lever, const PairResult& r, double dt, WallTotals& totals) {
  // torque on A about its centre turns into minus torque on the wall about any point, plus the lever
  const Vec3 on_wall = -r.force_a, torque_wall = cross(lever, on_wall) - r.torque_a;
  totals.work.add(-dt * (dot(on_wall, wall.velocity) + dot(torque_wall, wall.angular_velocity)));
  // Damping and friction take force times sliding velocity: the bodies' part is counted with them, this is the walls'.
  const Vec3 dissipative_force = -r.dissipative_force_a, dissipative_torque = cross(lever, dissipative_force) - r.dissipative_torque_a;
  totals.dissipated.add(-dt * (dot(dissipative_force, wall.velocity) + dot(dissipative_torque, wall.angular_velocity)));
}

/// in   begin, end   of the pairs with walls
void add_effects_of(std::size_t begin, std::size_t end, const RunState& s, double dt, WallTotals& totals) {
  PairResult of_block;
  ImpulsesOfWalls impulses(totals);
  for (std::size_t n = begin; n < end; ++n) {
    const std::int32_t k = s.pairs.with_walls()[n];
    const auto w = static_cast<std::size_t>(s.scene.zones()[static_cast<std::size_t>(s.pairs.zones_of_walls()[n])].wall);
    const WallState& state = s.walls[w];
    // one that stands still does no work
    if (stands_still(state) && !s.scene.has_moving_surfaces()) {
      if (const Vec3* force = s.pairs.force_of(k)) impulses.add(w, dt * -*force);
      continue;
    }
    const PairResult& r = s.pairs.result_of(k, of_block);
    if (!r.active) continue;
    impulses.add(w, dt * -r.force_a);
    const BodyPair& pair = s.pairs.stored_pairs()[static_cast<std::size_t>(k)];
    add_work_on(state, s.particles.x[static_cast<std::size_t>(pair.a)] - state.position, r, dt, totals);
    if (s.scene.has_moving_surfaces()) {
      totals.work.add(dt * r.surface_power);
      totals.dissipated.add(dt * r.surface_power);
    }
  }
}

/// Adds what is done to walls in parts, by several threads: the sums are exact.
/// in   action   (begin, end, totals) of the `count` things that each has   in   most   parts
template <class Action>
void add_in_parts(std::size_t count, std::size_t most, WallTotals& totals, Action&& action) {
  const std::size_t parts = std::clamp<std::size_t>(most, 1, static_cast<std::size_t>(omp_get_max_threads()));
  std::vector<WallTotals> others(parts - 1, WallTotals(totals.impulse.size()));
#pragma omp parallel for schedule(static, 1) if (parts > 1)
  for (std::size_t n = 0; n < parts; ++n) action(count * n / parts, count * (n + 1) / parts, n == 0 ? totals : others[n - 1]);
  for (WallTotals& other : others) add(other, totals);
}

}  // namespace

void add_wall_effects(const RunState& s, double dt, WallTotals& totals) {
  constexpr std::size_t kWorthAThread = 64;  // pairs, 45 us: starting a thread and adding its part takes some 5 us
  const std::size_t count = s.pairs.with_walls().size();
  add_in_parts(count, count / kWorthAThread, totals,
               [&](std::size_t begin, std::size_t end, WallTotals& part) { add_effects_of(begin, end, s, dt, part); });
}

void add_wall_effects_of_balls(const RunState& s, const std::vector<BallRow>& rows, double dt, std::span<const std::int32_t> outside,
                               WallTotals& totals) {
  const BallBlocks& blocks = s.pairs.blocks();
  const auto wall_of = [&s](std::int32_t zone) { return static_cast<std::size_t>(s.scene.zones()[static_cast<std::size_t>(zone)].wall); };
  const auto lever_of = [&](std::int32_t ball, const WallState& wall) { return rows[static_cast<std::size_t>(ball)].x.v - wall.position; };
  const std::vector<std::int32_t>& with_walls = blocks.with_walls();
  add_in_parts(with_walls.size(), with_walls.size(), totals, [&](std::size_t begin, std::size_t end, WallTotals& part) {
    PairResult r;
    ImpulsesOfWalls impulses(part);
    for (std::size_t n = begin; n < end; ++n) {
      const std::int32_t block = with_walls[n];
      const std::size_t wall = wall_of(s.scene.ball_laws().zones[static_cast<std::size_t>(blocks.wall_of(block))].zone);
      const WallState& state = s.walls[wall];
      blocks.for_each_slot(block, [&](const BallSlot& slot) { impulses.add(wall, dt * -slot.force); });
      if (stands_still(state)) continue;
      blocks.for_each_touching(block, [&](std::int32_t place) {
        blocks.load_result(place, r);
        add_work_on(state, lever_of(blocks.ball_of(place), state), r, dt, part);
      });
    }
  });
  ImpulsesOfWalls impulses(totals);
  for (const std::int32_t k : outside) {
    const BodyPair& pair = s.pairs.stored_pairs()[static_cast<std::size_t>(k)];
    const PairResult& r = s.pairs.stored_results()[static_cast<std::size_t>(k)];
    if (pair.b >= 0 || !r.active) continue;
    const std::size_t wall = wall_of(pair.key.zone);
    impulses.add(wall, dt * -r.force_a);
    if (const WallState& state = s.walls[wall]; !stands_still(state)) add_work_on(state, lever_of(pair.a, state), r, dt, totals);
  }
}

double contact_dissipation(const ParticleSet& p, std::size_t body, double dt) {
  if (p.fixed[body]) return 0;
  return -dt * (dot(p.dissipative_force[body], p.v[body]) + dot(p.dissipative_torque[body], p.w[body]));
}

void add_dissipation(RunState& s, double dt) {
  ParticleSet& p = s.particles;
  // what sleeps has no velocity
#pragma omp parallel
  for_awake_rows_of_thread(p, [&](std::size_t begin, std::size_t end) { add_dissipation_of_rows(p, dt, begin, end); });
}

}  // namespace scree
