#include "solver/effects/bonds/bonds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/error.hpp"
#include "core/base/index.hpp"
#include "core/base/units.hpp"
#include "core/storage/frame_file.hpp"
#include "solver/effects/bonds/shared_damping.hpp"
#include "solver/pairs/pair_evaluation.hpp"
#include "solver/ranks/failure.hpp"
#include "solver/state/run_state.hpp"
#include "solver/step_size/bond_stiffness.hpp"

namespace scree {

namespace {

/// Adds `share` times a bond's forces to the owned bodies of it.
void add_to_bodies(RunState& s, const ListedBond& bond, const BondForce& f, double share) {
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
void add_to_bodies(RunState& s, const BodyPair& pair, const PairResult& r) {
  add_to_bodies(s, {0, pair.a, pair.b, {}},
                {r.force_a, r.torque_a, r.torque_b, r.dissipative_force_a, r.dissipative_torque_a, r.dissipative_torque_b, {}, {}, 0}, 1);
}

/// Tells all ranks which bonds broke since they were told last. Collective.
void exchange_broken(RunState& s) {
  struct Broken {
    std::int32_t bond;
    std::int64_t step;
  };
  std::vector<Broken> mine;
  for (const std::int32_t bond : s.bonds->take_news()) mine.push_back({bond, s.bonds->broken_at()[at(bond)]});
  for (const Broken& b : s.comm.of_all(mine)) s.bonds->mark_broken(b.bond, b.step);
  s.bonds->take_news();  // those of others
}

/// The step in which each bond broke, known on every rank. Collective.
std::vector<std::int64_t> all_broken_at(const RunState& s) {
  std::vector<std::int64_t> all = s.bonds->broken_at();
  MPI_Allreduce(MPI_IN_PLACE, all.data(), static_cast<int>(all.size()), MPI_INT64_T, MPI_MAX, s.comm.get());
  return all;
}

class Bonds : public Effect {
 public:
  void begin(RunState& s) override { s.fragments->update(s.bonds->broken_at(), s.clock.step - s.clock.step % kReviewSteps); }
  void review(RunState& s) override;
  double extra_reach(const RunState& s, bool is_begin) const override;
  void after_migration(RunState& s, bool left) override;
  void on_rebuild(const StepParts& parts) override;
  void add_forces(RunState& s) override;
  void before_kick(const StepParts& parts) override;
  void end_step(const StepParts& parts) override;

  std::vector<BodyLink> links(const RunState& s) const override;
  void add_stiffness(const RunState& s, StabilityBound& bounds) const override;

  EffectRecord record(const RunState& s) const override;
  void restore(RunState& s, const EffectRecord& record) override;
  std::vector<ItemHash> hashes(const RunState& s) const override;
  void add_frame(const RunState& s, Frame& frame) const override;
  void add_energies(const RunState& s, Energies& energies) const override;
  void add_log_columns(const RunState& s, const Energies& energies, std::vector<Column>& columns) const override;
  std::vector<PlanLine> plan(const RunState& s) const override;

 private:
  std::vector<std::int32_t> shift_loaded(RunState& s) const;
  void replace_forces(RunState& s);

  std::vector<std::size_t> broken_;     // listed bonds that broke in this step
  std::vector<std::int32_t> touching_;  // pairs in their place
  ExactSum fracture_;                   // of this rank: energy of bonds as they broke, less that of the contacts in their place [J]
};

/// Every kReviewSteps steps: all ranks hear which bonds broke before, and find the fragments that are left. Collective.
void Bonds::review(RunState& s) {
  if (s.clock.substep != 0 || s.clock.step % kReviewSteps != 0) return;
  if (s.comm.size() > 1 && s.comm.max(s.bonds->has_news() ? 1.0 : 0.0) > 0) exchange_broken(s);
  if (s.fragments->update(s.bonds->broken_at(), s.clock.step)) s.fragments->assign_to(s.particles);
}

void Bonds::on_rebuild(const StepParts& parts) {
  RunState& s = parts.state;
  parts.failure.watch(s.clock.step, [&] { s.bonds->list(s.particles); });
  s.pairs.hold_apart([&](const PairKey& key) { return key.zone < 0 && s.bonds->holds(key); });
  s.fragments->assign_to(s.particles);
}

void Bonds::add_forces(RunState& s) {
  s.bonds->compute(s.particles);
  s.bonds->sum_onto_bodies(s.particles);
}

void Bonds::before_kick(const StepParts& parts) {
  RunState& s = parts.state;
  broken_ = s.bonds->overloaded();
  touching_.clear();
  if (broken_.empty()) return;
  const std::vector<Bond>& bonds = s.scene.source().bonds;
  for (const std::size_t k : broken_) {
    const ListedBond& bond = s.bonds->listed()[k];
    if (s.bonds->counts_here(bond, s.particles)) fracture_.add(s.bonds->forces()[k].energy);
    s.bonds->mark_broken(bond.bond, s.clock.step);
    const PairKey key{bonds[at(bond.bond)].a, bonds[at(bond.bond)].b, -1};
    if (s.bonds->holds(key)) continue;
    if (const std::int32_t pair = s.pairs.let_touch(key, s.particles); pair >= 0) touching_.push_back(pair);
  }
  std::sort(touching_.begin(), touching_.end());
  parts.compute_new_contacts(touching_);
  parts.compute_new_contacts(shift_loaded(s));
  for (const std::int32_t k : touching_) {
    const PairResult& r = s.pairs.results()[at(k)];
    if (r.active && counts_here(s.pairs.pairs()[at(k)], s.particles)) fracture_.add(-r.elastic);
  }
}

/// A contact that begins loaded must not hold more than its bonds held along the normal: the bond's energy is all that there is. It counts
/// its overlap from one that leaves it this much, until it has parted. Energies go with the square of the overlap, or a higher power, and
/// the smaller overlaps of a contact lose a larger share of theirs: what is left is at most that. Returns the pairs that were changed.
std::vector<std::int32_t> Bonds::shift_loaded(RunState& s) const {
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
        r.overlap_ratio * s.scene.max_overlap_of(s.particles.shape[a], s.particles.scale[a], s.particles.shape[b], s.particles.scale[b]);
    remember(pair.state.springs, RestOverlap{deepest * (1 - std::sqrt(held / r.elastic))});
    // a dent is that of the whole overlap: what is left of it presses the contact for the first time
    forget<Dent>(pair.state.springs);
    changed.push_back(k);
  }
  return changed;
}

void Bonds::end_step(const StepParts& parts) {
  replace_forces(parts.state);
  share_damping(parts.state);
}

void Bonds::replace_forces(RunState& s) {
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
  for (const std::size_t k : broken_) add_to_bodies(s, s.bonds->listed()[k], s.bonds->forces()[k], -1);
  for (const std::int32_t k : touching_) {
    if (s.pairs.results()[at(k)].active) add_to_bodies(s, s.pairs.pairs()[at(k)], s.pairs.results()[at(k)]);
  }
  for (const std::size_t i : rows) p.dissipated[i] += contact_dissipation(p, i, ahead);
  s.bonds->forget(broken_);
  broken_.clear();
}

double Bonds::extra_reach(const RunState& s, bool is_begin) const {
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
    for (const Place& place : s.comm.of_all(mine)) {
      places[place.id] = place.x;
      radii[place.id] = place.radius;
    }
    gap = s.bonds->farthest_gap(places, radii);
  } else {
    gap = s.bonds->farthest_gap(p);
  }
  return std::max(0.0, s.comm.max(gap) - 2 * s.scene.contact_range());
}

/// Tells all ranks which bonds broke since lists were made; those of bodies that left break too. Collective.
void Bonds::after_migration(RunState& s, bool left) {
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
    if (held[k] && s.bonds->is_broken(s.bonds->listed()[k]) && s.bonds->counted()[k]) fracture_.add(s.bonds->forces()[k].energy);
  }
}

std::vector<BodyLink> Bonds::links(const RunState& s) const {
  std::vector<BodyLink> links;
  for (const ListedBond& bond : s.bonds->listed()) {
    if (!s.bonds->is_broken(bond)) links.push_back({bond.a, bond.b});
  }
  return links;
}

void Bonds::add_stiffness(const RunState& s, StabilityBound& bounds) const {
  for (const ListedBond& bond : s.bonds->listed()) {
    if (!s.bonds->is_broken(bond)) bounds.add(linearise(*s.bonds, bond, s.particles));
  }
}

EffectRecord Bonds::record(const RunState& s) const {
  return {{.integers = all_broken_at(s)}, array_of(over_ranks(s.comm.get(), fracture_))};
}

void Bonds::restore(RunState& s, const EffectRecord& record) {
  const std::vector<std::int64_t>& broken_at = record[0].integers;
  const std::size_t bonds = s.scene.source().bonds.size();
  if (broken_at.size() != bonds) throw InputError("has {} bonds, the scene has {}", broken_at.size(), bonds);
  s.bonds->set_broken_at(broken_at);
  const ExactSum fracture = sum_of(record[1]);
  if (s.comm.rank() == 0) fracture_ = fracture;
}

/// One item for each bond that broke: the energies follow.
std::vector<ItemHash> Bonds::hashes(const RunState& s) const {
  std::vector<ItemHash> items;
  const std::vector<std::int64_t> broken_at = all_broken_at(s);
  for (std::size_t k = 0; k < broken_at.size(); ++k) {
    if (broken_at[k] == kHolds) continue;
    ItemHash& h = items.emplace_back();
    h.add(static_cast<std::int64_t>(k));
    h.add(broken_at[k]);
  }
  return items;
}

void Bonds::add_frame(const RunState& s, Frame& frame) const {
  frame.has_bonds = true;
  for (std::size_t k = 0; k < s.bonds->listed().size(); ++k) {
    const ListedBond& bond = s.bonds->listed()[k];
    if (s.bonds->is_broken(bond) || !s.bonds->counts_here(bond, s.particles)) continue;
    const BondForce& force = s.bonds->forces()[k];
    frame.bonds.bond.push_back(bond.bond);
    frame.bonds.force.push_back(force.force_a);
    frame.bonds.energy.push_back(force.energy);
    frame.bonds.load.push_back(bond_load(s.bonds->table()[at(bond.bond)], force));
  }
}

void Bonds::add_energies(const RunState& s, Energies& energies) const {
  ExactSum held;
  const std::vector<ListedBond>& bonds = s.bonds->listed();
  for (std::size_t k = 0; k < bonds.size(); ++k) {
    if (s.bonds->counts_here(bonds[k], s.particles)) held.add(s.bonds->forces()[k].energy);
  }
  energies.bond = over_ranks(s.comm.get(), held).value();
  energies.fracture = over_ranks(s.comm.get(), fracture_).value();
}

void Bonds::add_log_columns(const RunState& s, const Energies& energies, std::vector<Column>& columns) const {
  const std::vector<std::int64_t> broken_at = all_broken_at(s);
  columns.push_back({"bond", "J", exact(energies.bond)});
  columns.push_back({"fracture", "J", exact(energies.fracture)});
  columns.push_back({"bonds", "-", fmt::format("{}", std::count(broken_at.begin(), broken_at.end(), kHolds))});
}

std::vector<PlanLine> Bonds::plan(const RunState& s) const {
  const CriticalStep critical = critical_step_of_bonds(s.scene);
  return {{"bonds", fmt::format("{}, {} bytes each; critical step of the {} {}", s.scene.source().bonds.size(),
                                sizeof(Bond) + sizeof(ListedBond) + sizeof(BondForce), critical.name(),
                                format_quantity(critical.step, Dimension::time))}};
}

/// The first bond that is not as it was recorded; "" if only energies differ.
std::string difference(const EffectRecord& recorded, const EffectRecord& now) {
  if (recorded.empty() || now.empty()) return "";
  for (std::size_t k = 0; k < std::min(recorded[0].integers.size(), now[0].integers.size()); ++k) {
    const std::int64_t a = recorded[0].integers[k], b = now[0].integers[k];
    if (a != b) return fmt::format("bond {}: recorded as broken at step {}, found {} (-1: holds)", k, a, b);
  }
  return "";
}

}  // namespace

EffectKind bonds_effect() {
  return {{"bonds", "what broken bonds held differs", {{"broken_at", "", 1, false}, sum_format("fracture")}, difference},
          {"bonds", "no [[bonds]]: no bodies hold together"},
          [](const RunState& s) -> std::unique_ptr<Effect> {
            if (s.scene.source().bonds.empty()) return nullptr;
            return std::make_unique<Bonds>();
          }};
}

}  // namespace scree
