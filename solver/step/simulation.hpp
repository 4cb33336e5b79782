// One rank's part of a run, and one step of it. The time loop is in run/run.cpp.
//
// What a run is made of lies in RunState, and each part that changes it has its own page: step_levels.hpp (how long a step is),
// neighbour_lists.hpp (when lists are rebuilt), domain.hpp (which bodies leave), decomposition.hpp (which rank computes what), forces.hpp.
// Measures: run/measures.hpp.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/storage/start_state.hpp"
#include "solver/ranks/agreement.hpp"
#include "solver/ranks/decomposition.hpp"
#include "solver/ranks/failure.hpp"
#include "solver/ranks/requests.hpp"
#include "solver/state/run_state.hpp"
#include "solver/step/arrivals.hpp"
#include "solver/step/ball_steps.hpp"
#include "solver/step/domain.hpp"
#include "solver/step/force_step.hpp"
#include "solver/step/inlets.hpp"
#include "solver/step/neighbour_lists.hpp"
#include "solver/step_size/critical_step.hpp"
#include "solver/step_size/step_levels.hpp"

namespace scree {

class OuterForces;

class Simulation {
 public:
  Simulation(const mpi::Communicator& comm, const SolverScene& scene, const ParallelOptions& options = {});

  /// Starts from the scene, or from a checkpoint: every rank gives its own part of the bodies, in any way, and the state of
  /// their pairs. `step_size` and its reason are kept as they were. Totals are those of all ranks, the same on each. Collective.
  /// in   start   of a scene whose first bodies come from a run
  void start_from_scene(const std::optional<StartState>& start = {});
  void start_from_records(const std::vector<ParticleRecord>& records, std::vector<WaitingState> state, std::int64_t step, double step_size,
                          const std::string& step_limited_by, const RunTotals& totals);
  /// After a start from records of an older version, once their hash has been compared: PairList::set_axes_of_springs().
  void set_axes_of_springs() { state_.pairs.set_axes_of_springs(state_.scene, state_.particles); }

  /// One step, or as many as go without a break up to step `last`. Collective.
  void advance(std::int64_t last = 0);

  /// Bodies that join in the next step, see Arrivals::add(). Collective.
  void add_bodies(const std::vector<ParticleRecord>& mine) { arrivals_.add(state_, mine); }

  /// Takes bodies out in the next step, as if they had left the domain. Each rank gives what it wants taken out, of any rank. Collective.
  /// Throws UsageError on every rank for an id that no body has.
  void remove_bodies(const std::vector<std::int64_t>& mine) { domain_.ask_removal(state_, mine); }

  /// Moves a wall with the motion `outer` at this rate [m/s] or [rad/s] from now on, on every rank alike.
  /// Throws UsageError for another wall, and for a rate above its maximum or not finite.
  void drive_wall(std::size_t wall, double rate);

  /// Bodies of this rank that are to join in the next step.
  const std::vector<ParticleRecord>& waiting_bodies() const { return arrivals_.waiting(); }
  /// Whether bodies are to join or to leave in the next step.
  bool bodies_wait() const { return arrivals_.are_waiting() || domain_.is_removal_asked(); }
  /// After a restart the forces of the last step are not known before the next one: until then results of contacts are those that they have
  /// where they stand, without damping. No state changes. Collective.
  void evaluate_contacts_at_rest();

  /// What acts from outside; made at the first call, on every rank alike, between two steps.
  OuterForces& outer_forces();
  /// The state, for what changes it between two steps: its functions are its own.
  RunState& changeable_state() { return state_; }

  /// Throws on every rank what one of them met in the last step. Called before anything is written, so that no rank waits in
  /// a collective write for one that failed, and no failure of the last step is lost. Collective.
  void agree_on_failures();

  /// Bodies that came in since the last call, by inlets and by add_bodies(), in the order of their steps; the same on every rank.
  std::vector<InsertedBody> take_inserted();
  /// Forgets which bodies came in and left since the last call, where no table is made of them.
  void drop_events();

  const RunState& state() const { return state_; }
  std::int64_t step() const { return state_.clock.step; }
  double time() const { return state_.clock.time(); }

  Requests& requests() { return requests_; }
  StepLevels& levels() { return levels_; }
  DomainGuard& domain() { return domain_; }
  NeighbourLists& lists() { return lists_; }
  const BallSteps& ball_steps() const { return ball_steps_; }
  Decomposition& decomposition() { return decomposition_; }
  PhaseTimes& times() { return state_.times; }

  /// Largest overlap over margin of all ranks since the last call, at every step. Collective.
  double take_max_overlap_ratio();
  /// Largest stable step of the present contacts, see stability.hpp. Collective.
  CriticalStep critical_step();
  /// Contacts that this rank counts, at the present state, with forces that are the same on any number of ranks; changes no state.
  /// Collective.
  FrameContacts contacts();

 private:
  void begin(const std::vector<ParticleRecord>& records, std::int64_t step, double step_size, bool is_cut);
  void advance_substep(std::int64_t last);
  bool go_on_with_balls(std::int64_t last);
  bool bring_lists_up_to_date();
  void advance_frozen();
  void freeze();
  void set_frozen_step();
  StepParts parts() { return {state_, forces_.scratch(), failure_, decomposition_.halo(), agree_, compute_new_contacts_, lists_.skin()}; }
  Effect& add_on_demand(std::size_t kind);
  void for_each_effect(void (Effect::*hook)(RunState&));
  void move_bodies();
  void finish_motion();
  StepReport agree_on_step(bool forced);
  void rebuild_lists(const StepReport& report);

  RunState state_;
  Decomposition decomposition_;
  Agreement agreement_;
  NeighbourLists lists_;
  StepLevels levels_;
  DomainGuard domain_;
  Arrivals arrivals_;
  Inlets inlets_;
  Requests requests_;
  FirstFailure failure_;  // of this rank; all ranks stop together, a step or two later
  ForceStep forces_;
  BallSteps ball_steps_;
  OuterForces* outer_forces_ = nullptr;  // among the effects of the state; null: there are none
  bool needs_lists_ = false;             // an effect has changed since the last step what they were made for
  std::function<void()> agree_;          // as effects call them
  std::function<void(const std::vector<std::int32_t>&)> compute_new_contacts_;
};

}  // namespace scree
