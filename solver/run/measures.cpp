#include "solver/run/measures.hpp"

#include <algorithm>
#include <concepts>
#include <cstring>

#include "core/storage/checksum.hpp"
#include "solver/bodies/motion.hpp"
#include "solver/effects/effects.hpp"
#include "solver/step/domain.hpp"

namespace scree {

namespace {

ItemHash hash_of(const InletState& inlet) {
  ItemHash h;
  h.add(inlet.count);
  h.add(inlet.mass);
  h.add(inlet.returned);
  for (const TransitBody& body : inlet.queue) h.add(body.id);
  return h;
}

/// Calls action(pair, result) for the pairs in contact that this rank counts.
template <class Action>
void for_each_contact(const RunState& s, Action&& action) {
  for (std::size_t k = 0; k < s.pairs.pairs().size(); ++k) {
    const PairResult& r = s.pairs.results()[k];
    if (r.active && counts_here(s.pairs.pairs()[k], s.particles)) action(s.pairs.pairs()[k], r);
  }
}

/// Totals of walls up to the present: half of what the forces of the last step were counted with lies ahead.
WallTotals wall_totals(const RunState& s) {
  WallTotals walls = s.totals.walls;
  add_wall_effects(s, -0.5 * s.clock.dt, walls);
  return over_ranks(s.comm.get(), std::move(walls));
}

}  // namespace

Energies energies_of(const RunState& s) {
  enum { translational, rotational, potential, elastic, tangential, dissipated, count };
  std::vector<ExactSum> e(count);
  const ParticleSet& p = s.particles;
  for (std::size_t i = 0; i < p.owned; ++i) {
    e[translational].add(translational_energy(p, i));
    e[rotational].add(rotational_energy(p, i));
    e[potential].add(potential_energy(s, p, i));
    e[dissipated].add(p.dissipated[i]);
    e[dissipated].add(contact_dissipation(p, i, -0.5 * s.clock.dt));  // as for walls: half of that of the last step lies ahead
  }
  for_each_contact(s, [&](const BodyPair&, const PairResult& r) {
    e[elastic].add(r.elastic);
    e[tangential].add(r.tangential_elastic);
  });
  add_over_ranks(s.comm.get(), e);
  const WallTotals walls = wall_totals(s);
  const DepartureTotals departed = over_ranks(s.comm.get(), s.totals.departed);
  Energies all;
  all.translational = e[translational].value();
  all.rotational = e[rotational].value();
  all.potential = e[potential].value();
  all.elastic = e[elastic].value();
  all.tangential_elastic = e[tangential].value();
  // What friction took out of the motion is in part stored in its springs: that part is not lost.
  all.dissipated = e[dissipated].value() + walls.dissipated.value() + departed.dissipated.value() - all.tangential_elastic;
  all.wall_work = walls.work.value();
  all.removed = departed.energy.value();
  all.arrived = over_ranks(s.comm.get(), s.totals.arrived).energy.value();
  for (const std::unique_ptr<Effect>& effect : s.effects) effect->add_energies(s, all);
  return all;
}

double potential_about_world(const RunState& s, const Vec3& origin) {
  if (origin == Vec3{}) return 0;
  std::vector<ExactSum> sum(1);
  for (std::size_t i = 0; i < s.particles.owned; ++i) sum[0].add(potential_energy_at(s, s.particles, i, origin));
  add_over_ranks(s.comm.get(), sum);
  return sum[0].value();
}

double shadow_energy_gap(const RunState& s) {
  const ParticleSet& p = s.particles;
  std::vector<ExactSum> sum(1);
  for (std::size_t i = 0; i < p.owned; ++i) {
    if (p.fixed[i]) continue;
    const Vec3 torque = rotate_inverse(p.q[i], p.torque[i]);
    const Vec3& w = p.inverse_inertia[i];
    sum[0].add(squared_length(p.force[i]) * p.inverse_mass[i] + torque.x * torque.x * w.x + torque.y * torque.y * w.y +
               torque.z * torque.z * w.z);
  }
  add_over_ranks(s.comm.get(), sum);
  return sum[0].value() * s.clock.dt * s.clock.dt / 8;
}

std::pair<std::int64_t, double> fastest_body(const RunState& s) {
  const ParticleSet& p = s.particles;
  double most = -1;
  std::int64_t id = -1;
  for (std::size_t i = 0; i < p.owned; ++i) {
    const double kinetic = translational_energy(p, i) + rotational_energy(p, i);
    if (kinetic > most || (kinetic == most && p.id[i] < id)) {
      most = kinetic;
      id = p.id[i];
    }
  }
  const double overall = s.comm.max(most);
  constexpr double kNone = 1e18;
  const double lowest = -s.comm.max(-(most == overall && id >= 0 ? static_cast<double>(id) : kNone));
  return {lowest < kNone ? static_cast<std::int64_t>(lowest) : -1, overall};
}

std::vector<WallLoad> wall_loads_of(const RunState& s) {
  const std::size_t walls = s.scene.source().walls.size();
  constexpr std::size_t kSums = 7;  // force, torque, power of the surface
  std::vector<ExactSum> now(kSums * walls);
  for (const std::int32_t k : s.pairs.with_walls()) {
    const PairResult& r = s.pairs.results()[static_cast<std::size_t>(k)];
    if (!r.active) continue;
    const BodyPair& pair = s.pairs.pairs()[static_cast<std::size_t>(k)];
    const auto w = static_cast<std::size_t>(s.scene.zones()[static_cast<std::size_t>(pair.key.zone)].wall);
    const Vec3 torque = cross(s.particles.x[static_cast<std::size_t>(pair.a)], -r.force_a) - r.torque_a;
    const double parts[kSums] = {-r.force_a.x, -r.force_a.y, -r.force_a.z, torque.x, torque.y, torque.z, r.surface_power};
    for (std::size_t i = 0; i < kSums; ++i) now[kSums * w + i].add(parts[i]);
  }
  add_over_ranks(s.comm.get(), now);
  const WallTotals totals = wall_totals(s);
  const auto vector = [](const ExactSum* sums) { return Vec3{sums[0].value(), sums[1].value(), sums[2].value()}; };
  std::vector<WallLoad> loads(walls);
  for (std::size_t w = 0; w < walls; ++w) {
    const ExactSum* of_wall = &now[kSums * w];
    loads[w] = {vector(of_wall), vector(of_wall + 3), vector(totals.impulse[w].data()), of_wall[6].value()};
  }
  return loads;
}

void move_loads_to_world(std::vector<WallLoad>& loads, std::vector<WallState>& walls, const Vec3& origin) {
  if (origin == Vec3{}) return;
  for (WallLoad& load : loads) load.torque += cross(origin, load.force);
  for (WallState& wall : walls) wall.position += origin;
}

std::vector<Column> columns_of_effects(const RunState& s, const Energies& energies) {
  std::vector<Column> columns;
  for (const std::unique_ptr<Effect>& effect : s.effects) effect->add_log_columns(s, energies, columns);
  return columns;
}

std::int64_t body_count(const RunState& s) { return s.comm.sum(static_cast<std::int64_t>(s.particles.owned)); }

std::int64_t free_body_count(const RunState& s) {
  std::int64_t count = 0;
  for (std::size_t i = 0; i < s.particles.owned; ++i) count += s.particles.fixed[i] ? 0 : 1;
  return s.comm.sum(count);
}

std::int64_t contact_count(const RunState& s) {
  std::int64_t count = 0;
  for_each_contact(s, [&](const BodyPair&, const PairResult& r) { count += r.contact_count; });
  return s.comm.sum(count);
}

std::int64_t deep_pair_count(const RunState& s) {
  std::int64_t count = 0;
  for_each_contact(s, [&](const BodyPair&, const PairResult& r) { count += r.overlap_ratio < kStopOverlapRatio ? 0 : 1; });
  return s.comm.sum(count);
}

std::int64_t active_pair_count(const RunState& s) {
  std::int64_t count = 0;
  for_each_contact(s, [&](const BodyPair&, const PairResult&) { ++count; });
  return s.comm.sum(count);
}

std::int64_t bodies_outside(const RunState& s) {
  std::int64_t count = 0;
  for (std::size_t i = 0; i < s.particles.owned; ++i) count += is_outside(s.scene, s.particles.x[i]) ? 1 : 0;
  return s.comm.sum(count);
}

RemovedTotals removed_totals(const RunState& s) {
  const DepartureTotals departed = over_ranks(s.comm.get(), s.totals.departed);
  return {departed.count.value(), departed.mass.value()};
}

std::vector<RemovedTotals> outlet_totals(const RunState& s) {
  std::vector<RemovedTotals> totals;
  for (const OutletTotals& outlet : over_ranks(s.comm.get(), s.totals.outlets))
    totals.push_back({outlet.count.value(), outlet.mass.value()});
  return totals;
}

RemovedTotals arrived_totals(const RunState& s) {
  const ArrivalTotals arrived = over_ranks(s.comm.get(), s.totals.arrived);
  return {arrived.count.value(), arrived.mass.value()};
}

std::int64_t arrived_count(const RunState& s) { return static_cast<std::int64_t>(arrived_totals(s).count); }

RunTotals overall_totals(const RunState& s) {
  RunTotals totals = over_ranks(s.comm.get(), s.totals);
  totals.max_overlap_ratio = s.comm.max(s.totals.max_overlap_ratio);
  totals.arrived = over_ranks(s.comm.get(), s.totals.arrived);
  totals.outlets = over_ranks(s.comm.get(), s.totals.outlets);
  if (s.scene.continues()) totals.deep = over_ranks(s.comm.get(), s.totals.deep);
  totals.level = s.clock.level;
  totals.effects.resize(effect_kinds().size());
  for (const std::unique_ptr<Effect>& effect : s.effects) totals.effects[effect->kind()] = effect->record(s);
  return totals;
}

std::string state_hash(const RunState& s) {
  const ParticleSet& p = s.particles;
  std::uint64_t sums[3] = {0, 0, p.owned};
  const auto add = [&](const ItemHash& h) {
    sums[0] += h.a;  // a sum modulo 2^64 of item hashes: no order of bodies or ranks enters
    sums[1] += h.b;
  };
  for (std::size_t i = 0; i < p.owned; ++i) {
    ItemHash h;
    for_each_body_column([&](const auto& c) {
      if (c.uses & kHashed) h.add((p.*c.column)[i]);
    });
    for_each_body_column([&](const auto& c) {
      const auto& value = (p.*c.column)[i];
      if ((c.uses & kIfNotZero) && value != std::decay_t<decltype(value)>{}) h.add(value);
    });
    add(h);
  }
  for (const BodyPair& pair : s.pairs.pairs()) {
    if (!counts_here(pair, p)) continue;
    for_each_kind(pair.state, [&](const auto& rows) {
      for (const auto& row : rows) {
        ItemHash h;
        h.add(pair.key.a);
        h.add(pair.key.b);
        h.add(static_cast<std::int64_t>(pair.key.zone));
        using Kind = KindOf<decltype(rows)>;
        Kind::visit([&](const char* name, const char*, auto field) {
          if (!is_later_column<Kind>(name) || row.*field != std::decay_t<decltype(row.*field)>{}) h.add(row.*field);
        });
        add(h);
      }
    });
  }
  for (const std::unique_ptr<Effect>& effect : s.effects) {
    const std::vector<ItemHash> items = effect->hashes(s);  // of all ranks: one of them adds them
    if (s.comm.rank() != 0) continue;
    for (const ItemHash& item : items) add(item);
  }
  if (s.comm.rank() == 0) {
    for (const InletState& inlet : s.totals.inlets) add(hash_of(inlet));
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPI_UINT64_T, MPI_SUM, s.comm.get());
  if (sums[2] == 0) {  // no body is a state too, and no hash of it would look like one that was never made
    ItemHash none;
    none.add(std::uint64_t{0});
    add(none);
  }
  return fmt::format("{:016x}{:016x}", sums[0], sums[1]);
}

RankMeasures rank_measures(Simulation& simulation) {
  const RunState& s = simulation.state();
  return simulation.decomposition().measures(s.particles, s.pairs, s.times);
}

}  // namespace scree
