#include "solver/effects/heat/heat.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/index.hpp"
#include "solver/bodies/kept_sum.hpp"
#include "solver/effects/heat/contact_losses.hpp"
#include "solver/effects/heat/heat_effect.hpp"
#include "solver/pairs/forces.hpp"
#include "solver/ranks/failure.hpp"
#include "solver/ranks/halo.hpp"

namespace scree {

namespace {

void sort_by_pair(std::vector<HeatEffect::Contact>& contacts) {
  std::sort(contacts.begin(), contacts.end(), [](const HeatEffect::Contact& l, const HeatEffect::Contact& r) { return l.pair < r.pair; });
}

/// Throws for what a scene with heat cannot have: a case is refused earlier, with its place.
void check_heat(const Scene& scene) {
  const Settings& settings = scene.settings;
  const Heat& heat = *settings.heat;
  if (!scene.bonds.empty())
    throw UsageError("[heat] cannot be combined with bonds: the conduction of bonds is not modelled; leave out one of both");
  for (const Material& m : scene.materials) {
    if (heat.has_gas() && (!(heat.gas_range > 0) || (m.conductivity > 0 && !(m.conductivity > kSolidOverGas * heat.gas_conductivity))))
      throw InputError("heat: gas_conductivity {:g} W/(m K) needs a gas_range and materials that conduct more than ten times as well",
                       heat.gas_conductivity);
  }
  if (!heat.frozen) return;
  const char* blocker = frozen_blocker(settings);
  for (const Wall& wall : scene.walls) blocker = blocker == nullptr ? frozen_blocker(wall) : blocker;
  if (blocker == nullptr && !scene.inlets.empty()) blocker = "[[inlets]]";
  if (blocker == nullptr && !scene.outlets.empty()) blocker = "[[outlets]]";
  if (blocker != nullptr) throw UsageError("heat.frozen keeps bodies as they are and cannot be combined with: {}", blocker);
}

}  // namespace

void HeatEffect::on_rebuild(const StepParts& parts) {
  const RunState& s = parts.state;
  at_rest_.assign(s.pairs.pairs().size(), -1.0);
  stored_.assign(friction_heat_ ? s.pairs.pairs().size() : 0, 0.0);
  source_rows_.clear();
  for (std::size_t i = 0; i < s.particles.owned && !sources_.empty(); ++i) {
    const auto found =
        std::lower_bound(sources_.begin(), sources_.end(), s.particles.id[i], [](const Source& l, std::int64_t id) { return l.id < id; });
    if (found != sources_.end() && found->id == s.particles.id[i]) source_rows_.emplace_back(i, found - sources_.begin());
  }
  if (gas_) gas_->find(parts);
  if (outer_) outer_->on_rebuild(s);
  if (s.scene.is_frozen()) find_frozen(parts);
}

/// Contacts and gaps of a scene in which nothing moves: once, at the start and at a restart.
void HeatEffect::find_frozen(const StepParts& parts) {
  RunState& s = parts.state;
  contacts_.clear();
  if (!parts.failure.exists()) {
    parts.failure.watch(s.clock.step, [&] {
      for (const auto* which : {&s.pairs.inner(), &s.pairs.outer(), &s.pairs.duplicated()}) {
        visit_pairs(s.scene, s.particles, s.walls, *which, s.clock.step, parts.scratch, s.pairs, [&](const PairContact& contact) {
          contacts_.push_back({static_cast<std::int32_t>(&contact.pair - s.pairs.pairs().data()), conductance_.of(contact, s.particles)});
        });
      }
    });
  }
  sort_by_pair(contacts_);
  list_flows(s);
}

void HeatEffect::before_forces(RunState& s) {
  for (std::vector<Contact>& of_thread : seen_) of_thread.clear();
  for (std::size_t k = 0; k < stored_.size(); ++k) {
    const BodyPair& pair = s.pairs.pairs()[k];
    stored_[k] = pair.state.springs.empty() ? 0 : stored_in_springs(pair);
  }
}

void HeatEffect::start(RunState& s) {
  if (!s.scene.is_frozen()) {
    collect_contacts();
    list_flows(s);
  }
  review_conduction(s);
  if (!friction_heat_) return;
  // the first kick is by half a step, in which springs stay as they are
  for (std::size_t k = 0; k < stored_.size(); ++k) stored_[k] = stored_in_springs(s.pairs.pairs()[k]);
  given_.assign(s.particles.owned, 0.0);
  add_made(s, 0.5);
  for (std::size_t i = 0; i < s.particles.owned; ++i) heat_body(s.particles, i, given_[i]);
}

void HeatEffect::collect_contacts() {
  contacts_.clear();
  for (const std::vector<Contact>& of_thread : seen_) contacts_.insert(contacts_.end(), of_thread.begin(), of_thread.end());
  sort_by_pair(contacts_);
}

/// Contacts, then gaps: each body adds up its flows in an order that is the same on any number of ranks and threads.
void HeatEffect::list_flows(const RunState& s) {
  flows_.clear();
  for (const Contact& contact : contacts_) {
    const BodyPair& pair = s.pairs.pairs()[at(contact.pair)];
    flows_.push_back({pair.a, pair.b, pair.b < 0 ? s.scene.zones()[at(pair.key.zone)].wall : -1, contact.conductance});
  }
  if (!gas_) return;
  gas_->measure(s);
  for (const GasGaps::Gap& gap : gas_->gaps()) {
    if (!(gap.conductance > 0)) continue;
    const NearPair& pair = gap.pair;
    flows_.push_back({pair.a, pair.b, pair.b < 0 ? s.scene.zones()[at(pair.key.zone)].wall : -1, gap.conductance});
  }
}

/// Contacts of which neither side moves are not computed in a step: what they conduct follows from where they are.
void HeatEffect::add_resting(const StepParts& parts) {
  RunState& s = parts.state;
  for (const Contact& contact : contacts_) at_rest_[at(contact.pair)] = -1;
  std::vector<std::int32_t> unknown;
  std::vector<Contact> all;
  all.reserve(contacts_.size());
  auto next = contacts_.begin();
  for (std::size_t k = 0; k < s.pairs.results().size(); ++k) {
    const auto pair = static_cast<std::int32_t>(k);
    if (next != contacts_.end() && next->pair == pair) {
      all.push_back(*next++);
    } else if (s.pairs.results()[k].active) {
      if (at_rest_[k] < 0) unknown.push_back(pair);
      all.push_back({pair, -1});
    }
  }
  for (const std::int32_t pair : unknown) at_rest_[at(pair)] = 0;
  if (!unknown.empty() && !parts.failure.exists()) {
    parts.failure.watch(s.clock.step, [&] {
      visit_pairs(s.scene, s.particles, s.walls, unknown, s.clock.step, parts.scratch, s.pairs, [&](const PairContact& contact) {
        at_rest_[static_cast<std::size_t>(&contact.pair - s.pairs.pairs().data())] = conductance_.of(contact, s.particles);
      });
    });
  }
  for (Contact& contact : all) {
    if (contact.conductance < 0) contact.conductance = at_rest_[at(contact.pair)];
  }
  contacts_ = std::move(all);
}

/// Critical step and largest Biot number of the present contacts of this rank.
void HeatEffect::review_conduction(const RunState& s) {
  const ParticleSet& p = s.particles;
  std::vector<double> sum(p.owned, 0.0);
  for (const Flow& flow : flows_) {
    if (flow.wall >= 0 && !wall_of(flow).heat.has_temperature()) continue;
    for (const std::int32_t row : {flow.a, flow.b}) {
      if (row >= 0 && at(row) < p.owned) sum[at(row)] += flow.conductance;
    }
  }
  if (outer_) outer_->add_conductance(sum);
  double least = std::numeric_limits<double>::infinity(), biot = 0;
  std::int64_t body = -1;
  std::size_t body_row = 0;
  for (std::size_t i = 0; i < p.owned; ++i) {
    if (!(sum[i] > 0)) continue;
    const double step = capacity(p, i) / sum[i];
    if (step < least || (step == least && p.id[i] < body)) {
      least = step;
      body = p.id[i];
      body_row = i;
    }
    const Shape& shape = s.scene.source().shapes[at(p.shape[i])];
    const double area = shape.area * p.scale[i] * p.scale[i];
    const double volume = s.scene.shape(p.shape[i]).volume * p.scale[i] * p.scale[i] * p.scale[i];
    biot = std::max(biot, sum[i] * volume / (s.scene.source().materials[at(p.material[i])].conductivity * area * area));
  }
  critical_step_ = least;
  critical_body_ = body;
  critical_medium_ = outer_ && body >= 0 && least < s.clock.dt ? outer_->conductance_of(body_row) : 0;  // for the message of check_step()
  biot_ = biot;
}

StepBound HeatEffect::bound(const RunState& s) const {
  const double step = -s.comm.max(-critical_step_);
  if (std::isinf(step)) return {};
  constexpr double kNoBody = -0x1p53;
  const double body = -s.comm.max(critical_step_ == step ? -static_cast<double>(critical_body_) : kNoBody);
  return {step, fmt::format("conduction of body {:.0f}", body)};
}

void HeatEffect::check_step(const StepParts& parts) const {
  const RunState& s = parts.state;
  if (s.clock.dt <= critical_step_) return;
  if (critical_medium_ > 0) {
    parts.failure.keep(
        RunInvalid("step {}: body {} exchanges heat so well that its temperature is stable with a step of at most {:.3g} s, its mass times "
                   "its heat_capacity over the conductances of its contacts and of the medium that the program gives it, {:.3g} W/K of the "
                   "latter; the run has {:.3g} s. Give time.step, a larger heat_capacity, or the medium a smaller conductance",
                   s.clock.step, critical_body_, critical_step_, critical_medium_, s.clock.dt),
        s.clock.step);
    return;
  }
  parts.failure.keep(
      RunInvalid("step {}: body {} conducts so well that its temperature is stable with a step of at most {:.3g} s, its mass times its "
                 "heat_capacity over the conductances of its contacts; the run has {:.3g} s. Give time.step, or a larger heat_capacity",
                 s.clock.step, critical_body_, critical_step_, s.clock.dt),
      s.clock.step);
}

/// What contacts have dissipated in a step, to both sides.   in   share   of the step
void HeatEffect::add_made(const RunState& s, double share) {
  const ParticleSet& p = s.particles;
  for (std::size_t k = 0; k < stored_.size(); ++k) {
    const BodyPair& pair = s.pairs.pairs()[k];
    const bool active = s.pairs.results()[k].active;
    if (!active && stored_[k] == 0) continue;
    const double now = pair.state.springs.empty() ? 0 : stored_in_springs(pair);
    add_loss(pair, p.owned, (active ? contact_loss(s, k, share * s.clock.dt) : 0) + stored_[k] - now);
  }
}

/// Half to each side.   in   owned   rows of bodies of this rank     in   loss   of the contact [J]
void HeatEffect::add_loss(const BodyPair& pair, std::size_t owned, double loss) {
  const double half = 0.5 * loss;
  if (half == 0) return;
  for (const std::int32_t row : {pair.a, pair.b}) {
    if (row < 0) {
      totals_[kMadeInWalls].add(half);
    } else if (at(row) < owned) {
      given_[at(row)] += half;
      totals_[kMade].add(half);
    }
  }
}

/// As for all that is dissipated (StepLevels::change).
void HeatEffect::on_step_change(RunState& s, double difference) {
  if (!friction_heat_) return;
  ParticleSet& p = s.particles;
  given_.assign(p.owned, 0.0);
  for (std::size_t k = 0; k < s.pairs.results().size(); ++k)
    if (s.pairs.results()[k].active) add_loss(s.pairs.pairs()[k], p.owned, contact_loss(s, k, difference));
  for (std::size_t i = 0; i < p.owned; ++i) heat_body(p, i, given_[i]);
}

/// Half of what its contacts were counted with in the last step lies ahead and is not to come: the body that stops gives its part back, as
/// it does of `dissipated`.
void HeatEffect::falls_asleep(RunState& s, std::size_t row) {
  if (!friction_heat_) return;
  const double heat = contact_dissipation(s.particles, row, -0.5 * s.clock.dt);
  totals_[kMade].add(heat);
  heat_body(s.particles, row, heat);
}

/// What the case gives to bodies in the step: tables by their mean over it.
void HeatEffect::add_sources(const RunState& s) {
  const double dt = s.clock.dt, now = s.clock.time();
  std::vector<double> of_tables;
  for (const TimeTable& table : s.scene.source().settings.heat->source_tables) of_tables.push_back(table.mean(now - dt, now));
  for (const auto& [row, index] : source_rows_) {
    const Source& source = sources_[index];
    const double heat = dt * (source.table < 0 ? source.power : source.power + of_tables[at(source.table)]);
    given_[row] += heat;
    totals_[kFromSources].add(heat);
  }
}

/// What walls with a flux give in the step, shared in proportion to conductances. Collective.
void HeatEffect::add_flux(const RunState& s) {
  const std::vector<Wall>& walls = s.scene.source().walls;
  std::vector<ExactSum> sums(walls.size());
  for (const Flow& flow : flows_) {
    if (flow.wall >= 0) sums[at(flow.wall)].add(flow.conductance);
  }
  add_over_ranks(s.comm.get(), sums);
  std::vector<double> per_conductance(walls.size(), 0.0);
  for (std::size_t w = 0; w < walls.size(); ++w) {
    if (walls[w].heat.kind != WallHeatKind::flux) continue;
    pending_[w] += walls[w].heat.flux.mean(s.clock.time() - s.clock.dt, s.clock.time()) * s.clock.dt;
    const double sum = sums[w].value();
    if (sum > 0) per_conductance[w] = std::exchange(pending_[w], 0.0) / sum;
  }
  for (const Flow& flow : flows_) {
    if (flow.wall < 0) continue;
    const std::size_t w = at(flow.wall);
    const double heat = per_conductance[w] * flow.conductance;
    if (heat == 0) continue;
    given_[at(flow.a)] += heat;
    to_bodies_[w].add(heat);
    flow_now_[w].add(heat / s.clock.dt);
  }
}

/// Of each wall at a time [K]; 0 where it has none.
std::vector<double> HeatEffect::temperatures_of_walls(double time) const {
  std::vector<double> all;
  for (const Wall& wall : state_.scene.source().walls) all.push_back(wall.heat.temperature.at(time));
  return all;
}

/// Power that flows into each owned row at these temperatures of walls and rows.   in/out   power   [W]
void HeatEffect::add_conducted(const RunState& s, const std::vector<double>& of_walls, const std::vector<double>& temperature,
                               std::vector<double>& power) const {
  const std::size_t owned = s.particles.owned;
  for (const Flow& flow : flows_) {
    const auto a = at(flow.a);
    if (flow.b >= 0) {
      const auto b = at(flow.b);
      const double to_a = flow.conductance * (temperature[b] - temperature[a]);
      if (a < owned) power[a] += to_a;
      if (b < owned) power[b] -= to_a;
    } else if (wall_of(flow).heat.has_temperature()) {
      power[a] += flow.conductance * (of_walls[at(flow.wall)] - temperature[a]);
    }
  }
}

void HeatEffect::heat_body(ParticleSet& p, std::size_t row, double heat) {
  if (heat == 0) return;
  add_keeping_rest(heat / capacity(p, row), p.temperature[row], p.temperature_remainder[row]);
}

/// Two Euler steps, averaged. Collective.
void HeatEffect::advance(const StepParts& parts) {
  RunState& s = parts.state;
  ParticleSet& p = s.particles;
  const double dt = s.clock.dt;
  const std::vector<double> walls_first = temperatures_of_walls(s.clock.time() - dt), walls = temperatures_of_walls(s.clock.time());
  parts.halo.refresh_column(p.temperature, s.times);
  power_first_.assign(p.owned, 0.0);
  add_conducted(s, walls_first, p.temperature, power_first_);
  if (outer_) outer_->add_power(p.temperature, power_first_);
  stage_ = p.temperature;
  for (std::size_t i = 0; i < p.owned; ++i) stage_[i] += (dt * power_first_[i] + given_[i]) / capacity(p, i);
  parts.halo.refresh_column(stage_, s.times);
  power_.assign(p.owned, 0.0);
  add_conducted(s, walls, stage_, power_);
  if (outer_) {
    outer_->add_power(stage_, power_);
    outer_->count_passed(dt, p.temperature, stage_);
  }
  for (const Flow& flow : flows_) {
    if (flow.wall < 0 || !wall_of(flow).heat.has_temperature()) continue;
    const std::size_t w = at(flow.wall), a = at(flow.a);
    const double power = 0.5 * flow.conductance * ((walls_first[w] - p.temperature[a]) + (walls[w] - stage_[a]));
    to_bodies_[w].add(dt * power);
    flow_now_[w].add(power);
  }
  for (std::size_t i = 0; i < p.owned; ++i) {
    heat_body(p, i, 0.5 * dt * (power_first_[i] + power_[i]) + given_[i]);
    if (p.temperature[i] > 0) continue;
    parts.failure.keep(RunInvalid("step {}: body {} is cooled to {:.4g} K, below absolute zero; take less from it (heat_source, heat_flux, "
                                  "the sources of a program)",
                                  s.clock.step, p.id[i], p.temperature[i]),
                       s.clock.step);
  }
}

void HeatEffect::end_step(const StepParts& parts) {
  RunState& s = parts.state;
  ParticleSet& p = s.particles;
  if (!s.scene.is_frozen()) {
    collect_contacts();
    if (s.sleep) add_resting(parts);
    list_flows(s);
  }
  review_conduction(s);
  check_step(parts);
  given_.assign(p.owned, 0.0);
  std::fill(flow_now_.begin(), flow_now_.end(), ExactSum{});
  if (friction_heat_) {
    // a body is heated by half of what its contact takes from both sides: ghosts need the velocities of the end of the step
    parts.halo.start_refresh(p, s.times);
    parts.halo.finish_refresh(p, s.times);
    add_made(s, 1);
  }
  add_sources(s);
  if (outer_) outer_->add_sources(s.clock.dt, given_);
  if (has_flux_) add_flux(s);
  advance(parts);
}

EffectKind heat_effect() {
  EffectFormat format{"heat", "what contacts, walls or sources gave to bodies as heat differs", {}};
  for (const char* name : kHeatTotalNames) format.arrays.push_back(sum_format(name));
  format.arrays.push_back(sum_format("walls"));
  format.arrays.push_back({"pending", "J"});
  for (const ArrayFormat& array : OuterHeat::formats()) format.arrays.push_back(array);
  return {format, {"heat", "no [heat]: bodies have no temperature"}, [](const RunState& s) -> std::unique_ptr<Effect> {
            if (!s.scene.source().settings.heat) return nullptr;
            check_heat(s.scene.source());
            return std::make_unique<HeatEffect>(s);
          }};
}

}  // namespace scree
