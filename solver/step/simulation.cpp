#include "solver/step/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "solver/built_with.hpp"
#include "solver/effects/effects.hpp"
#include "solver/effects/outer_forces/outer_forces.hpp"
#include "solver/effects/sleep/sleep.hpp"
#include "solver/step/leaving_contacts.hpp"
#include "solver/step/start_from_run.hpp"
#include "solver/step_size/frozen_step.hpp"
#include "solver/step_size/stability.hpp"
#include "solver/step_size/step_size.hpp"

namespace scree {

namespace {

/// This rank's bodies of a scene. One that is cut for these ranks starts as it is cut; else bodies are dealt out in equal runs, to be
/// cut at once.
std::vector<ParticleRecord> own_records(const mpi::Communicator& comm, const SolverScene& scene, const std::optional<StartState>& start) {
  const BodyTable& bodies = scene.source().bodies;
  const bool is_cut = scene.source().partition.ranks == comm.size();
  const auto ranks = static_cast<std::size_t>(comm.size()), me = static_cast<std::size_t>(comm.rank());
  std::vector<ParticleRecord> mine;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const std::size_t owner = is_cut ? static_cast<std::size_t>(bodies.owner[b]) : b * ranks / bodies.size();
    if (owner == me) mine.push_back(start ? starting_record(scene, *start, b) : initial_record(scene, b));
  }
  return mine;
}

/// Steps that may pass before whoever asks for them is heard again: some tenths of a second.
std::int64_t most_steps_at_once(const RunState& s) {
  constexpr double kMostBodySteps = 4e6;
  constexpr double kFewest = 16, kMost = 4096;
  return static_cast<std::int64_t>(std::clamp(kMostBodySteps / static_cast<double>(s.particles.owned + 1), kFewest, kMost));
}

}  // namespace

Simulation::Simulation(const mpi::Communicator& comm, const SolverScene& scene, const ParallelOptions& options)
    : state_(comm, scene), decomposition_(comm, scene, options), agreement_(comm), inlets_(scene) {
  agree_ = [this] { agree_on_failures(); };
  compute_new_contacts_ = [this](const std::vector<std::int32_t>& which) { forces_.compute_new_contacts(state_, failure_, which); };
  state_.effects = make_effects(state_);
  state_.sleep = state_.effect<Sleep>();
}

/// Makes an effect that no scene needs, at its place in the order of effects.
Effect& Simulation::add_on_demand(std::size_t kind) {
  std::unique_ptr<Effect> effect = effect_kinds()[kind].make_on_demand(state_);
  effect->set_kind(kind);
  const auto at = std::find_if(state_.effects.begin(), state_.effects.end(), [kind](const auto& other) { return other->kind() > kind; });
  Effect& added = **state_.effects.insert(at, std::move(effect));
  if (auto* const outer = dynamic_cast<OuterForces*>(&added)) outer_forces_ = outer;
  return added;
}

OuterForces& Simulation::outer_forces() {
  if (outer_forces_ != nullptr) return *outer_forces_;
  std::size_t kind = 0;
  while (effect_kinds()[kind].make_on_demand == nullptr) ++kind;
  return dynamic_cast<OuterForces&>(add_on_demand(kind));
}

void Simulation::drive_wall(std::size_t wall, double rate) {
  const Wall& known = state_.scene.source().walls[wall];
  const Drive* drive = state_.scene.drive(wall);
  if (drive == nullptr || !drive->is_outer)
    throw UsageError(
        "drive: wall '{}' is not moved from outside; give it motion = {{ outer = {{ direction = [0, 0, 1], max_speed = \"0.1 m/s\" }} }}",
        known.name);
  if (!(std::abs(rate) <= drive->most_rate))
    throw UsageError("drive: wall '{}' is to move at {:g} {}, above its {} of {:g}; raise it in the case, or stay below", known.name, rate,
                     drive->guide.turns ? "rad/s" : "m/s", drive->guide.turns ? "max_rate" : "max_speed", drive->most_rate);
  state_.drives[wall].asked = rate;
}

void Simulation::for_each_effect(void (Effect::*hook)(RunState&)) {
  for (const std::unique_ptr<Effect>& effect : state_.effects) (*effect.*hook)(state_);
}

void Simulation::start_from_scene(const std::optional<StartState>& start) {
  const std::vector<ParticleRecord> records = own_records(state_.comm, state_.scene, start);
  if (start) mpi::on_all(state_.comm, [&] { state_.pairs.waiting() = starting_pairs(state_.scene, *start, records); });
  begin(records, 0, 0, decomposition_.has_cut());
  if (start) set_axes_of_springs();
  if (state_.scene.is_frozen()) {
    if (start) count_starting_springs(state_);
    for_each_effect(&Effect::start);
    set_frozen_step();
    agree_on_failures();
    return;
  }
  // The forces of a checkpoint are those of its last step; only a fresh start computes them, with springs at rest.
  forces_.compute(state_, decomposition_, failure_, 0, false);
  // contacts that there are from the start on may ask for a shorter step, for which damping is computed again
  if (levels_.begin_with_contacts(state_, forces_.scratch(), failure_)) forces_.compute(state_, decomposition_, failure_, 0, false);
  if (start) count_starting_springs(state_);
  for_each_effect(&Effect::start);
  // the first kick is by half a step
  add_wall_effects(state_, 0.5 * state_.clock.dt, state_.totals.walls);
  add_dissipation(state_, 0.5 * state_.clock.dt);
  agree_on_failures();
}

void Simulation::start_from_records(const std::vector<ParticleRecord>& records, std::vector<WaitingState> state, std::int64_t step,
                                    double step_size, const std::string& step_limited_by, const RunTotals& totals) {
  state_.pairs.waiting() = std::move(state);
  if (state_.comm.rank() == 0) state_.totals = totals;
  state_.totals.max_overlap_ratio = totals.max_overlap_ratio;
  state_.totals.largest_id = totals.largest_id;
  state_.totals.inlets = totals.inlets;
  state_.totals.effects.clear();
  for (std::size_t k = 0; k < totals.effects.size(); ++k) {
    const bool is_there = std::any_of(state_.effects.begin(), state_.effects.end(), [k](const auto& e) { return e->kind() == k; });
    if (!totals.effects[k].empty() && effect_kinds()[k].make_on_demand != nullptr && !is_there) add_on_demand(k);
  }
  for (const std::unique_ptr<Effect>& effect : state_.effects) {
    // a record that is missing, of an older version, leaves what a scene begins with; the state hash judges it
    if (effect->kind() < totals.effects.size() && !totals.effects[effect->kind()].empty())
      mpi::on_all(state_.comm, [&] { effect->restore(state_, totals.effects[effect->kind()]); });
  }
  state_.largest_id = std::max(state_.largest_id, totals.largest_id);
  state_.clock.level = totals.level;
  begin(records, step, step_size, false);
  // bodies that came in or left since would give another reason for the same step
  if (!step_limited_by.empty()) state_.clock.size.limited_by = step_limited_by;
}

void Simulation::begin(const std::vector<ParticleRecord>& records, std::int64_t step, double step_size, bool is_cut) {
  ParticleSet& p = state_.particles;
  StepClock& clock = state_.clock;
  for (const ParticleRecord& r : records) append_record(p, r, state_.scene);
  p.owned = p.size();
  std::fill(p.work.begin(), p.work.end(), 0.0);
  mpi::on_all(state_.comm, [&] { check_built_with(state_.comm, state_.scene, p); });
  state_.facts = agree_on_facts(state_.comm, p);
  clock.step = step;
  if (state_.scene.is_frozen()) {
    for (std::size_t i = 0; i < p.owned; ++i) p.v[i] = p.L[i] = p.w[i] = {};
    clock.size = frozen_step_size(state_.scene.source().settings);
  } else {
    mpi::on_all(state_.comm, [&] { clock.size = derive_step_size(state_.comm, state_.scene, p); });
  }
  if (step_size > 0) clock.size.step = step_size;  // a run keeps the step that it began with
  clock.set_level(clock.level);
  state_.set_walls();
  mpi::on_all(state_.comm, [&] { for_each_effect(&Effect::begin); });
  if (step == 0 && !state_.scene.is_frozen()) levels_.begin(state_, forces_.scratch(), failure_);
  lists_.begin(state_);
  if (!is_cut && state_.comm.size() > 1) decomposition_.cut_again(p, state_.pairs, true);
  agreement_.start(lists_.look(state_, false));
  rebuild_lists(agreement_.finish());
  lists_.set_fastest(std::numeric_limits<double>::infinity());  // forces are not known yet
  agree_on_failures();
  if (state_.scene.is_frozen()) freeze();
}

/// Results of contacts whose bodies stay as they are: a function of places and springs, after a restart as at the start. Collective.
void Simulation::freeze() {
  evaluate_contacts_at_rest();
  state_.pairs.sum_onto_bodies(state_.scene.source().settings.gravity, state_.particles);
  for_each_effect(&Effect::add_forces);
}

void Simulation::evaluate_contacts_at_rest() {
  failure_.watch(step(), [&] {
    for (const auto* which : {&state_.pairs.inner(), &state_.pairs.outer(), &state_.pairs.duplicated()})
      evaluate_at_rest(state_.scene, state_.particles, state_.walls, *which, state_.clock.dt, step(), forces_.scratch(), state_.pairs);
  });
  agree_on_failures();
}

/// Nothing moves: effects alone bound the step. It divides the time between two frames. Collective.
void Simulation::set_frozen_step() {
  StepBound bound;
  for (const std::unique_ptr<Effect>& effect : state_.effects) {
    const StepBound other = effect->bound(state_);
    if (other.step < bound.step) bound = other;
  }
  mpi::on_all(state_.comm, [&] { limit_frozen_step(bound, state_.scene.source().settings, state_.clock.size); });
  state_.clock.set_level(0);
}

void Simulation::advance(std::int64_t last) {
  if (state_.scene.is_frozen()) return advance_frozen();
  const std::int64_t next = step() + 1;
  last = std::min(last, step() + most_steps_at_once(state_));
  while (step() < next) advance_substep(last);
  for (const std::unique_ptr<Effect>& effect : state_.effects) needs_lists_ = effect->after_step(parts()) || needs_lists_;
  levels_.review(state_, forces_.scratch(), failure_);
}

/// Time passes for effects; lists, contacts and forces hold until the end.
void Simulation::advance_frozen() {
  state_.clock.advance();
  const StepReport all = agree_on_step(false);
  requests_.hear(all);
  if (all.failed != 0) agree_on_failures();
  for (const std::unique_ptr<Effect>& effect : state_.effects) effect->end_step(parts());
}

void Simulation::advance_substep(std::int64_t last) {
  move_bodies();
  bool is_rebuilt = false;
  do {
    is_rebuilt = bring_lists_up_to_date();
  } while (go_on_with_balls(last));
  forces_.compute(state_, decomposition_, failure_, state_.clock.dt, !is_rebuilt);
  // a function of a program fails for reasons of the program: the error is of this step, and not of one or two steps later
  if (outer_forces_ != nullptr && outer_forces_->has_functions()) agree_on_failures();
  for (const std::unique_ptr<Effect>& effect : state_.effects) effect->before_kick(parts());
  finish_motion();
  for (const std::unique_ptr<Effect>& effect : state_.effects) effect->end_step(parts());
}

/// Steps of balls in one go, until something else is needed in between. Returns whether bodies are in a later step now.
bool Simulation::go_on_with_balls(std::int64_t last) {
  if (requests_.pending_signal() != 0 || requests_.is_checkpoint_asked()) return false;
  return ball_steps_.run(state_, forces_, decomposition_.balance(), failure_, lists_, requests_, last);
}

/// Bodies have moved: those that leave or come do, and lists are made again where they are used up. Returns whether they were.
bool Simulation::bring_lists_up_to_date() {
  const bool level_changed = levels_.take_change(), bodies_leave = domain_.review(state_, failure_);
  for_each_effect(&Effect::review);
  inlets_.feed(state_, arrivals_);
  const StepReport all = agree_on_step(level_changed || bodies_leave || arrivals_.are_waiting() || std::exchange(needs_lists_, false));
  requests_.hear(all);
  if (all.failed != 0) agree_on_failures();
  if (all.rebuild != 0) rebuild_lists(all);
  return all.rebuild != 0;
}

void Simulation::move_bodies() {
  const PhaseTimer timer(state_.times, Phase::integrate);
  Balance& balance = decomposition_.balance();
  const WorkTimer work(balance.computing(), balance.weight_of(step()));
  failure_.watch(step(), [&] { for_each_effect(&Effect::before_drift); });
  begin_step(state_.integrator, state_.particles, state_.clock.dt, state_.fluid_forces());
  if (state_.scene.periodicity().any()) wrap_positions(state_.particles);
  failure_.watch(step(), [&] { for_each_effect(&Effect::drift); });
  state_.clock.advance();
  const auto cause_of = [this](std::size_t row) {
    return outer_forces_ == nullptr ? std::string() : outer_forces_->cause_of_motion(state_, row);
  };
  failure_.watch(step(), [&] { check_displacement(state_, cause_of); });
  if (state_.scene.has_driven_walls() || state_.scene.has_moving_surfaces()) state_.set_walls();
}

void Simulation::finish_motion() {
  const PhaseTimer timer(state_.times, Phase::integrate);
  Balance& balance = decomposition_.balance();
  const WorkTimer work(balance.computing(), balance.weight_of(step()));
  end_step(state_.integrator, state_.particles, state_.clock.dt, state_.fluid_forces());
  failure_.watch(step(), [&] { for_each_effect(&Effect::after_kick); });
  add_wall_effects(state_, state_.clock.dt, state_.totals.walls);
  // The force of step n acts over a whole step around it, with the mean velocity of that step: that of the full step.
  add_dissipation(state_, state_.clock.dt);
}

StepReport Simulation::agree_on_step(bool forced) {
  // what was asked for this step in the one before, when ranks looked ahead
  StepReport asked;
  if (agreement_.has_report()) {
    const PhaseTimer timer(state_.times, Phase::agree);
    asked = agreement_.take();
    lists_.set_fastest(asked.fastest);
  }
  asked.fastest = lists_.fastest();
  if (forced) asked.rebuild = 1;
  const bool rebuilt = asked.rebuild != 0, ahead = lists_.may_agree_ahead(state_, rebuilt);
  StepReport mine = lists_.look(state_, rebuilt);
  if (ahead && lists_.are_overrun()) {
    failure_.keep(RunInvalid("step {}: a body or wall went further in one step than all that moved before; use a step of at most {:.3g} s",
                             step(), 0.5 * state_.clock.dt),
                  step());
  }
  requests_.fill(mine);
  mine.failed = failure_.exists() ? 1 : 0;
  decomposition_.balance().tell(mine);
  if (!built_with::kRanks || state_.comm.size() == 1) {
    mine.rebuild = std::max(mine.rebuild, asked.rebuild);
    return mine;
  }
  const PhaseTimer timer(state_.times, Phase::agree);
  agreement_.start(mine);
  if (ahead) return asked;
  StepReport now = agreement_.finish();
  lists_.set_fastest(now.fastest);
  now.rebuild = std::max(now.rebuild, asked.rebuild);
  now.signal = std::max(now.signal, asked.signal);
  now.failed = std::max(now.failed, asked.failed);
  now.checkpoint = std::max(now.checkpoint, asked.checkpoint);
  return now;
}

std::vector<InsertedBody> Simulation::take_inserted() {
  std::vector<InsertedBody> all = inlets_.take_inserted();
  const std::vector<InsertedBody> added = arrivals_.take_inserted();
  all.insert(all.end(), added.begin(), added.end());
  std::stable_sort(all.begin(), all.end(), [](const InsertedBody& l, const InsertedBody& r) { return l.step < r.step; });
  return all;
}

void Simulation::drop_events() {
  take_inserted();
  domain_.drop_removed();
}

void Simulation::agree_on_failures() {
  agreement_.finish_early();
  failure_.agree(state_.comm);
}

void Simulation::rebuild_lists(const StepReport& report) {
  ParticleSet& p = state_.particles;
  {
    const PhaseTimer timer(state_.times, Phase::migrate);
    if (!failure_.exists()) failure_.watch(step(), [&] { check_finite(state_); });
    agree_on_failures();
    double further = 0;
    for (const std::unique_ptr<Effect>& effect : state_.effects)
      further = std::max(further, effect->extra_reach(state_, lists_.rebuilds() == 0));
    std::vector<std::int64_t> disturbed;
    if (state_.sleep && domain_.is_removal_due()) disturbed = state_.sleep->touching_those_that_leave(state_, domain_.leaving(state_));
    if (domain_.is_removal_due()) count_contacts_of_leaving(state_, domain_.leaving(state_));
    decomposition_.distribute(p, state_.pairs, report);
    if (state_.sleep) Sleep::wake(state_, disturbed);
    const bool left = domain_.remove(state_), came = arrivals_.join(state_, decomposition_.halo());
    if (left || came) agree_on_bodies(state_);
    for (const std::unique_ptr<Effect>& effect : state_.effects) effect->after_migration(state_, left);
    lists_.set_skin(state_, report.fastest);
    if (built_with::kRanks) decomposition_.halo().make_ghosts(state_.scene, p, state_.facts.largest_radius, lists_.skin() + further);
  }
  lists_.rebuild(state_, decomposition_.balance());
  for (const std::unique_ptr<Effect>& effect : state_.effects) effect->on_rebuild(parts());
}

double Simulation::take_max_overlap_ratio() {
  if (state_.sleep || state_.scene.is_frozen()) {  // pairs at rest have not been computed since
    for (const PairResult& r : state_.pairs.results())
      if (r.active) state_.totals.max_overlap_ratio = std::max(state_.totals.max_overlap_ratio, r.overlap_ratio);
  }
  return state_.comm.max(std::exchange(state_.totals.max_overlap_ratio, 0.0));
}

CriticalStep Simulation::critical_step() {
  if (state_.scene.is_frozen()) return {};
  return scree::critical_step(state_, forces_.scratch());
}

FrameContacts Simulation::contacts() { return forces_.contacts(state_, decomposition_.halo()); }

}  // namespace scree
