// The state of a run on one rank, and one step of it. The time loop is run() in run.cpp.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "solver/bodies/fluid.hpp"
#include "solver/bodies/motion.hpp"
#include "solver/phases.hpp"
#include "solver/ranks/agreement.hpp"
#include "solver/ranks/balance.hpp"
#include "solver/ranks/exact_sum.hpp"
#include "solver/ranks/halo.hpp"
#include "solver/ranks/rank_measures.hpp"
#include "solver/step/critical_step.hpp"
#include "solver/step/forces.hpp"
#include "solver/step/step_size.hpp"

namespace scree {

/// Energies of the whole scene [J], at a full step.
struct Energies {
  double translational = 0, rotational = 0, potential = 0, elastic = 0, tangential_elastic = 0;
  double dissipated = 0;  ///< accumulated from the damping and friction forces, never the remainder
  double wall_work = 0;   ///< done by driven walls on the bodies
  double removed = 0;     ///< kinetic and potential, taken away by bodies that left the domain
  double balance() const {
    return translational + rotational + potential + elastic + tangential_elastic + dissipated - wall_work + removed;
  }
};

/// What a wall received since the start.
struct WallLoad {
  Vec3 force;    ///< now, on the wall [N]
  Vec3 torque;   ///< now, about the world origin [N m]
  Vec3 impulse;  ///< since the start [N s]
  /// Of the wall on the bodies, now [W].
  double power(const WallState& wall) const {
    return -dot(force, wall.velocity) - dot(torque - cross(wall.position, force), wall.angular_velocity);
  }
};

/// The step changed, at the end of a step.
struct StepChange {
  std::int64_t step;
  double time, step_size;
  std::string reason;
};

/// A body that left the domain and was taken out.
struct RemovedBody {
  std::int64_t id, step;
  double time, mass;
  Vec3 x, v;
};

/// Number and mass [kg] of all removed bodies.
struct RemovedTotals {
  double count = 0, mass = 0;
};

/// What a run has added up since its start besides bodies and springs; part of a checkpoint.
struct RunTotals {
  /// Places in `sums`.
  static constexpr std::size_t kWallWork = 0, kWallDissipated = 1, kRemovedCount = 2, kRemovedMass = 3, kRemovedEnergy = 4,
                               kRemovedDissipated = 5, kFirstImpulse = 6;
  /// Of this rank, or of all: work of driven walls, their part of what is dissipated [J]; bodies removed from the domain, their
  /// mass [kg], their kinetic and potential energy, what they had dissipated [J]; then three components of the impulse on each wall [N s].
  /// The forces of the last step count in full; the measures below take half of them back.
  std::vector<ExactSum> sums;
  double max_overlap_ratio = 0;  ///< since it was last taken
  std::int64_t level = 0;        ///< of the step, see Simulation::advance
};

class Simulation {
 public:
  Simulation(const mpi::Communicator& comm, const SolverScene& scene, const ParallelOptions& options = {});

  /// Starts from the scene, or from a checkpoint: every rank gives its own part of the bodies, in any way, and the springs of
  /// their pairs. `step_size` is kept as it was. Totals are those of all ranks, the same on each.
  void start_from_scene();
  void start_from_records(const std::vector<ParticleRecord>& records, std::vector<WaitingState> state, std::int64_t step, double step_size,
                          const RunTotals& totals);

  /// One step, in 2^level equal parts of: kick, drift, lists or ghosts, forces, kick. Collective.
  void advance();

  /// Throws on every rank what one of them met in the last step. Called before anything is written, so that no rank waits in
  /// a collective write for one that failed, and no failure of the last step is lost. Collective.
  void agree_on_failures();

  /// What all ranks share after each step: the largest signal number seen by any rank, 0 when none.
  int pending_signal() const { return signal_; }

  /// A checkpoint that one rank's clock asks for: rank 0 asks, and within two steps all ranks hear it at the same step, with what
  /// they exchange anyhow. Whoever writes one, for whatever reason, calls checkpoint_written() on every rank.
  void ask_for_checkpoint() { checkpoint_asked_ = checkpoints_ + 1; }
  bool is_checkpoint_asked() const { return checkpoint_heard_ > checkpoints_; }
  void checkpoint_written() { ++checkpoints_; }

  std::int64_t step() const { return step_; }
  double time() const { return static_cast<double>(step_) * step_size_.step + static_cast<double>(substep_) * dt_; }
  /// What the bodies move by at once [s]: step_size().step, or with quantised steps that divided by a power of two.
  double substep_size() const { return dt_; }
  const StepSize& step_size() const { return step_size_; }
  const ParticleSet& particles() const { return p_; }
  const PairList& pairs() const { return pairs_; }
  const std::vector<WallState>& walls() const { return walls_; }
  const SolverScene& scene() const { return scene_; }

  // collective measures; every rank gets the whole scene's value
  Energies energies() const;
  RunTotals totals() const;
  std::vector<WallLoad> wall_loads() const;
  std::int64_t body_count() const { return comm_.sum(static_cast<std::int64_t>(p_.owned)); }
  std::int64_t contact_count() const;
  std::int64_t active_pair_count() const;
  double take_max_overlap_ratio();      ///< largest since the last call, at every step
  double take_imbalance();              ///< largest over mean computing time of the ranks since the last call
  std::int64_t bodies_outside() const;  ///< of the domain
  /// Largest stable step of the contacts that there are now, and the pair that sets it.
  CriticalStep critical_step();
  /// What the energies of a leapfrog swing by at this step [J]: h^2 / 8 times the sum of squared forces over masses. The
  /// difference of both is kept exactly by linear contacts at any stable step.
  double shadow_energy_gap() const;
  /// The body with the most kinetic energy, and that energy [J].
  std::pair<std::int64_t, double> fastest_body() const;
  RemovedTotals removed() const;  ///< since the start
  /// Changes of the step since the last call, the same on every rank.
  std::vector<StepChange> take_step_changes() { return std::exchange(step_changes_, {}); }
  /// Bodies removed since the last call, by step and id; on rank 0. Collective.
  std::vector<RemovedBody> take_removed();
  /// 128-bit hash over the bits of all bodies and friction springs, the same for any distribution over ranks.
  std::string state_hash() const;

  /// Drops all kept candidates and has the body lists made anew: results never depend on them (for tests).
  void forget_candidates() {
    pairs_.forget_candidates();
    rebuild_asked_ = true;
  }

  /// Contacts that this rank counts, at the present state, with forces that are the same on any number of ranks; changes no state.
  /// Collective.
  FrameContacts contacts();

  PhaseTimes& times() { return times_; }
  RankMeasures rank_measures() const;  ///< of this rank alone
  std::int64_t list_rebuilds() const { return rebuilds_; }
  std::int64_t cuts() const { return cuts_; }
  std::int64_t migrated() const { return migrated_; }

 private:
  void begin(const std::vector<ParticleRecord>& records, std::int64_t step, double step_size, bool is_cut);
  void advance_substep();
  StepReport agree_on_step(bool forced);
  StepReport look_at_lists(bool rebuilt, double speed_of_lists);
  double list_skin(double fastest) const;  // [m]
  bool may_look_ahead(double skin) const;
  void rebuild_lists(const StepReport& report);
  void cut_anew(bool is_first);
  void compute_forces(double friction_dt, bool refresh);
  void add_ways(std::size_t begin, std::size_t end);
  void compute_pairs(std::span<const std::int32_t> which, double friction_dt, Phase phase);
  void fail(const Error& error);
  void set_walls(double time);
  void add_wall_totals(double dt, std::vector<ExactSum>& sums) const;
  void add_wall_totals(std::span<const std::int32_t> pairs, double dt, std::vector<ExactSum>& sums) const;  // of some wall pairs
  double walls_moved(const std::vector<WallState>& from, const std::vector<WallState>& to) const;  // with respect to any owned body [m]
  double fastest_wall(const std::vector<WallState>& walls) const;  // fastest point of a wall near an owned body [m/s]
  /// Whether something that must happen at the same step in every run is due, such as the removal of bodies: asks for new lists.
  bool review();
  void choose_level(bool with_contacts);
  void check_displacement();

  // domain.cpp
  bool is_outside(const Vec3& x) const;
  bool any_left_domain() const;
  void check_finite() const;  // that the state of every body is
  void check_domain() const;  // that nobody left it; called in review() only, since lists are rebuilt at other steps on other ranks
  void remove_outside();
  double potential_energy(std::size_t i) const;
  const FluidForces* fluid() const { return fluid_ ? &*fluid_ : nullptr; }

  const mpi::Communicator& comm_;
  const SolverScene& scene_;
  ParallelOptions options_;
  Integrator integrator_;
  std::optional<FluidForces> fluid_;  // of a scene that has one
  ParticleSet p_;
  PairList pairs_;
  std::unique_ptr<Halo> halo_;
  Agreement agreement_;
  std::optional<StepReport> reports_;  // of the step before, when somebody needed them early
  Balance balance_;
  ForceScratch scratch_;
  StepSize step_size_;
  std::vector<WallState> walls_, walls_listed_;
  std::vector<std::int32_t> wall_pairs_;  // indices of pairs with a wall
  std::vector<ExactSum> sums_;            // of this rank, see RunTotals
  std::int64_t step_ = 0, rebuilds_ = 0, cuts_ = 0, migrated_ = 0, failure_step_ = 0;
  double skin_ = 0, smallest_radius_ = 0, max_overlap_ratio_ = 0, computed_before_ = 0;
  double fastest_ = 0;  // of all ranks, as far as known; infinite until a step was made
  bool lists_overrun_ = false, rebuild_asked_ = false;
  std::vector<RemovedBody> removed_;  // by this rank, not taken yet
  bool removal_due_ = false;
  double dt_ = 0;                         // the step divided by 2^level_
  std::int64_t level_ = 0, substep_ = 0;  // parts of the present step that are done
  bool level_changed_ = false;
  std::vector<StepChange> step_changes_;
  int signal_ = 0;
  std::int64_t checkpoint_asked_ = 0, checkpoint_heard_ = 0,
               checkpoints_ = 0;    // numbers: report of one that is written by now ask for nothing
  std::unique_ptr<Error> failure_;  // of this rank; all ranks stop together, a step or two later
  PhaseTimes times_{};
};

/// Installs handlers of SIGINT, SIGTERM and SIGUSR1 that ask the run to stop at the next step.
void catch_signals();

}  // namespace scree
