#include "solver/step/bonds.hpp"

#include "solver/pairs/pair_evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace scree {

namespace {

std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

/// Adds `share` times a bond's forces to the owned bodies of it.
void add_forces(RunState& s, const ListedBond& bond, const BondForce& f, double share) {
  ParticleSet& p = s.particles;
  const auto add = [&](std::size_t i, double side, const Vec3& torque, const Vec3& dissipative_torque) {
    if (i >= p.owned) return;
    p.force[i] += (share * side) * f.force_a;
    p.torque[i] += share * torque;
    p.dissipative_force[i] += (share * side) * f.dissipative_force_a;
    p.dissipative_torque[i] += share * dissipative_torque;
  };
  add(at(bond.a), 1, f.torque_a, f.dissipative_torque_a);
  add(at(bond.b), -1, f.torque_b, f.dissipative_torque_b);
}

/// The same of a contact.
void add_forces(RunState& s, const BodyPair& pair, const PairResult& r) {
  add_forces(s, {0, pair.a, pair.b, {}},
             {r.force_a, r.torque_a, r.torque_b, r.dissipative_force_a, r.dissipative_torque_a, r.dissipative_torque_b, {}, {}, 0}, 1);
}

/// Of the fracture energy: what a bond held as it stopped to hold.
void book(RunState& s, const ListedBond& bond, const BondForce& f) {
  if (s.bonds->counts_here(bond, s.particles)) s.totals.fracture.add(f.energy);
}

}  // namespace

void add_given_forces(RunState& s) {
  for (const GivenForce& given : s.given_forces) {
    if (s.particles.rest[given.row] != kAsleep) s.particles.force[given.row] += given.force;
  }
}

void add_bonds(RunState& s) {
  s.bonds->compute(s.particles);
  s.bonds->sum_onto_bodies(s.particles);
}

void Breakage::decide(RunState& s, ForceStep& forces, FirstFailure& failure) {
  broken_ = s.bonds->overloaded();
  touching_.clear();
  if (broken_.empty()) return;
  const std::vector<Bond>& bonds = s.scene.source().bonds;
  for (const std::size_t k : broken_) {
    const ListedBond& bond = s.bonds->listed()[k];
    book(s, bond, s.bonds->forces()[k]);
    s.bonds->mark_broken(bond.bond, s.clock.step);
    const PairKey key{bonds[at(bond.bond)].a, bonds[at(bond.bond)].b, -1};
    if (s.bonds->holds(key)) continue;
    if (const std::int32_t pair = s.pairs.let_touch(key, s.particles); pair >= 0) touching_.push_back(pair);
  }
  std::sort(touching_.begin(), touching_.end());
  forces.compute_begun(s, failure, touching_);
  forces.compute_begun(s, failure, shift_loaded(s));
  for (const std::int32_t k : touching_) {
    const PairResult& r = s.pairs.results()[at(k)];
    if (r.active && counts_here(s.pairs.pairs()[at(k)], s.particles)) s.totals.fracture.add(-r.elastic);
  }
}

/// A contact that begins loaded must not hold more than its bonds held along the normal: the bond's energy is all that there is. It counts
/// its overlap from one that leaves it this much, until it has parted. Energies go with the square of the overlap, or a higher power, and
/// the smaller overlaps of a contact lose a larger share of theirs: what is left is at most that. Returns the pairs that were changed.
std::vector<std::int32_t> Breakage::shift_loaded(RunState& s) const {
  std::vector<std::int32_t> changed;
  for (const std::int32_t k : touching_) {
    BodyPair& pair = s.pairs.pairs()[at(k)];
    const PairResult& r = s.pairs.results()[at(k)];
    if (!r.active || !(r.elastic > 0)) continue;
    double held = 0;
    for (const std::size_t n : broken_) {
      const ListedBond& bond = s.bonds->listed()[n];
      if (bond.a != pair.a || bond.b != pair.b) continue;
      const double d = s.bonds->forces()[n].displacement.x;
      if (d < 0) held += 0.5 * bond.law.push.x * d * d;
    }
    if (!(r.elastic > held)) continue;
    const auto a = at(pair.a), b = at(pair.b);
    const double deepest =
        r.overlap_ratio * s.scene.room_of(s.particles.shape[a], s.particles.scale[a], s.particles.shape[b], s.particles.scale[b]);
    set_rest_overlap(pair.state.springs, deepest * (1 - std::sqrt(held / r.elastic)));
    changed.push_back(k);
  }
  return changed;
}

void Breakage::replace_forces(RunState& s) {
  if (broken_.empty()) return;
  ParticleSet& p = s.particles;
  const double ahead = 0.5 * s.clock.dt;
  std::vector<std::size_t> rows;
  for (const std::size_t k : broken_) {
    for (const std::int32_t row : {s.bonds->listed()[k].a, s.bonds->listed()[k].b}) {
      if (at(row) < p.owned) rows.push_back(at(row));
    }
  }
  std::sort(rows.begin(), rows.end());
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  // what damping of this step takes was booked for the half step ahead as well, in which other forces act
  for (const std::size_t i : rows) p.dissipated[i] -= contact_dissipation(p, i, ahead);
  for (const std::size_t k : broken_) add_forces(s, s.bonds->listed()[k], s.bonds->forces()[k], -1);
  for (const std::int32_t k : touching_) {
    if (s.pairs.results()[at(k)].active) add_forces(s, s.pairs.pairs()[at(k)], s.pairs.results()[at(k)]);
  }
  for (const std::size_t i : rows) p.dissipated[i] += contact_dissipation(p, i, ahead);
  s.bonds->forget(broken_);
  broken_.clear();
}

double extra_reach(const RunState& s, bool is_begin) {
  if (s.comm.size() == 1) return 0;
  const ParticleSet& p = s.particles;
  double gap = 0;
  if (is_begin) {
    // a rank does not yet see whom its bodies are bonded to: all hear of all bonded bodies, once
    struct Place {
      std::int64_t id;
      Vec3 x;
      double radius;
    };
    const std::vector<std::int64_t>& bonded = s.bonds->bodies();
    std::vector<Place> mine;
    for (std::size_t i = 0; i < p.owned; ++i) {
      if (std::binary_search(bonded.begin(), bonded.end(), p.id[i])) mine.push_back({p.id[i], p.x[i], p.radius[i]});
    }
    std::map<std::int64_t, Vec3> places;
    std::map<std::int64_t, double> radii;
    for (const auto& block : s.comm.exchange(std::vector<std::vector<Place>>(static_cast<std::size_t>(s.comm.size()), mine))) {
      for (const Place& place : block) {
        places[place.id] = place.x;
        radii[place.id] = place.radius;
      }
    }
    gap = s.bonds->farthest_gap(places, radii);
  } else {
    gap = s.bonds->farthest_gap(p);
  }
  return std::max(0.0, s.comm.max(gap) - 2 * s.scene.contact_range());
}

namespace {

/// Tells all ranks which bonds broke since they were told last. Collective.
void exchange_broken(RunState& s) {
  struct Broken {
    std::int32_t bond;
    std::int64_t step;
  };
  std::vector<Broken> mine;
  for (const std::int32_t bond : s.bonds->take_news()) mine.push_back({bond, s.bonds->broken_at()[at(bond)]});
  for (const auto& block : s.comm.exchange(std::vector<std::vector<Broken>>(static_cast<std::size_t>(s.comm.size()), mine))) {
    for (const Broken& b : block) s.bonds->mark_broken(b.bond, b.step);
  }
  s.bonds->take_news();  // those of others
}

}  // namespace

void review_fragments(RunState& s) {
  if (s.clock.substep != 0 || s.clock.step % kReviewSteps != 0) return;
  if (s.comm.size() > 1 && s.comm.max(s.bonds->has_news() ? 1.0 : 0.0) > 0) exchange_broken(s);
  if (s.fragments->update(s.bonds->broken_at(), s.clock.step)) s.fragments->assign_to(s.particles);
}

void begin_fragments(RunState& s) { s.fragments->update(s.bonds->broken_at(), s.clock.step - s.clock.step % kReviewSteps); }

std::vector<std::int64_t> all_broken_at(const RunState& s) {
  std::vector<std::int64_t> all = s.bonds->broken_at();
  MPI_Allreduce(MPI_IN_PLACE, all.data(), static_cast<int>(all.size()), MPI_INT64_T, MPI_MAX, s.comm.get());
  return all;
}

void share_broken(RunState& s, bool left) {
  // what a listed bond held is booked where the bond was counted, which only now hears that one of its bodies is gone
  const auto count = s.bonds->listed().size();
  std::vector<bool> held(count);
  for (std::size_t k = 0; k < count; ++k) held[k] = !s.bonds->is_broken(s.bonds->listed()[k]);
  if (s.comm.size() > 1)
    exchange_broken(s);
  else
    s.bonds->take_news();
  if (!left) return;
  const std::vector<std::int64_t>& bonded = s.bonds->bodies();
  std::vector<std::uint8_t> is_here(bonded.size(), 0);
  const ParticleSet& p = s.particles;
  for (std::size_t i = 0; i < p.owned; ++i) {
    const auto found = std::lower_bound(bonded.begin(), bonded.end(), p.id[i]);
    if (found != bonded.end() && *found == p.id[i]) is_here[static_cast<std::size_t>(found - bonded.begin())] = 1;
  }
  MPI_Allreduce(MPI_IN_PLACE, is_here.data(), static_cast<int>(is_here.size()), MPI_UINT8_T, MPI_MAX, s.comm.get());
  const auto is_gone = [&](std::int64_t id) {
    return is_here[static_cast<std::size_t>(std::lower_bound(bonded.begin(), bonded.end(), id) - bonded.begin())] == 0;
  };
  const std::vector<Bond>& bonds = s.scene.source().bonds;
  for (std::size_t k = 0; k < bonds.size(); ++k) {
    if (s.bonds->broken_at()[k] == kHolds && (is_gone(bonds[k].a) || is_gone(bonds[k].b)))
      s.bonds->mark_broken(static_cast<std::int32_t>(k), s.clock.step);
  }
  s.bonds->take_news();
  for (std::size_t k = 0; k < count; ++k) {
    if (held[k] && s.bonds->is_broken(s.bonds->listed()[k]) && s.bonds->counted()[k]) s.totals.fracture.add(s.bonds->forces()[k].energy);
  }
}

void list_bonds(RunState& s, FirstFailure& failure) {
  if (s.bonds) {
    failure.watch(s.clock.step, [&] { s.bonds->list(s.particles); });
    s.pairs.hold_apart([&](const PairKey& key) { return key.zone < 0 && s.bonds->holds(key); });
    s.fragments->assign_to(s.particles);
  }
  s.given_forces.clear();
  const std::vector<BodyForce>& given = s.scene.source().forces;
  for (std::size_t i = 0; !given.empty() && i < s.particles.owned; ++i) {
    if (const BodyForce* f = s.scene.given_force(s.particles.id[i])) s.given_forces.push_back({i, f->force});
  }
}

PairStiffness linearise(const BondList& bonds, const ListedBond& bond, const ParticleSet& p) {
  PairStiffness result;
  const Bond& of = bonds.table()[at(bond.bond)];
  result.key = {of.a, of.b, kBondZone};
  result.a = bond.a;
  result.b = bond.b;
  const std::size_t a = at(bond.a), b = at(bond.b);
  const auto mode = [&](const Vec3& force, const Vec3& torque) {
    const Vec3 fa = rotate(bond.law.frame_a, force), fb = -rotate(bond.law.frame_b, force);
    const Vec3 ta = cross(bond.law.arm_a, fa) + rotate(bond.law.frame_a, torque);
    const Vec3 tb = cross(bond.law.arm_b, fb) - rotate(bond.law.frame_b, torque);
    const double ma = std::sqrt(p.inverse_mass[a]), mb = std::sqrt(p.inverse_mass[b]);
    std::array<double, 12> m{};
    for (int k = 0; k < 3; ++k) {
      const auto n = static_cast<std::size_t>(k);
      m[n] = ma * fa[k];
      m[3 + n] = std::sqrt(p.inverse_inertia[a][k]) * ta[k];
      m[6 + n] = mb * fb[k];
      m[9 + n] = std::sqrt(p.inverse_inertia[b][k]) * tb[k];
    }
    return m;
  };
  for (int k = 0; k < 3; ++k) {
    Vec3 unit;
    unit[k] = 1;
    result.add_mode(bond.law.push[k], bond.law.push_damping[k], mode(unit, {}));
    result.add_mode(bond.law.turn[k], bond.law.turn_damping[k], mode({}, unit));
  }
  return result;
}

CriticalStep critical_step_of_bonds(const SolverScene& scene) {
  if (scene.source().bonds.empty()) return {};
  ParticleSet p;
  BondList bonds(scene);
  const BodyTable& bodies = scene.source().bodies;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (std::binary_search(bonds.bodies().begin(), bonds.bodies().end(), bodies.id[b])) append_record(p, initial_record(scene, b), scene);
  }
  p.owned = p.size();
  bonds.list(p);
  StabilityBound bound(p.size());
  for (const ListedBond& bond : bonds.listed()) bound.add(linearise(bonds, bond, p));
  return bound.critical_step(false);
}

}  // namespace scree
