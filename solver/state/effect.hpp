// What a scene may have besides bodies, contacts and walls is an effect: one folder in effects/, which declares what it does in a step and
// what it keeps. A scene holds only the effects that it needs, and pays for no other. Step, checkpoint, state hash, log, frame and plan go
// over the list and know none by its name.
//
// Source: the shape of LAMMPS' fixes and granular sub-models, of OpenMC's filters and of exaDEM's operators.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "solver/pairs/pair_observer.hpp"
#include "solver/state/column.hpp"
#include "solver/state/effect_record.hpp"
#include "solver/state/energies.hpp"
#include "solver/state/item_hash.hpp"
#include "solver/state/step_clock.hpp"

namespace scree {

class FirstFailure;
class Halo;
class SolverScene;
class StabilityBound;
struct ForceScratch;
struct Frame;
struct RunState;

/// What hooks that compute pairs, refresh ghosts or may fail need beyond the state.
struct StepParts {
  RunState& state;
  ForceScratch& scratch;
  FirstFailure& failure;
  Halo& halo;
  /// Throws on every rank what one of them met. Collective.
  const std::function<void()>& agree_on_failures;
  /// Computes pairs that have just begun, by their numbers: no observer is shown them, and bodies do not get their forces in this step.
  const std::function<void(const std::vector<std::int32_t>&)>& compute_new_contacts;
  double skin;  ///< lists hold while no body moves further than half of it [m]
};

/// Rows of two bodies that hold together without a contact.
struct BodyLink {
  std::int32_t a, b;
};

/// A line of `--plan`: name and text.
using PlanLine = std::pair<std::string, std::string>;

/// All functions are called on every rank, in the order of the list (effects/effects.cpp), and may be collective.
class Effect {
 public:
  virtual ~Effect() = default;

  // 1. The start of a run or of a restart.
  /// Bodies, step and walls are there; neighbour lists are not.
  virtual void begin(RunState&) {}
  /// A run from its scene alone: the forces of the start are there. The first kick is by half a step.
  virtual void start(RunState&) {}

  // 2. A step, in this order.
  /// Bodies are about to move by the step. What is thrown is kept as in drift().
  virtual void before_drift(RunState&) {}
  /// Bodies have moved by the step, walls have not, the clock shows the time before. What is thrown is kept until all ranks stop.
  virtual void drift(RunState&) {}
  /// The clock shows the end of the step, ranks have not agreed on it yet.
  virtual void review(RunState&) {}
  /// Whether none of its functions of 2 would do anything, until lists are made again or a program asks for something: steps may leave
  /// them out.
  virtual bool is_idle() const { return false; }
  /// Only if neighbour lists are made again. Bodies are on their ranks, ghosts are not there yet.   in   left   whether bodies left the run
  virtual void after_migration(RunState&, bool /*left*/) {}
  /// The same: lists are new, rows and pairs are others.
  virtual void on_rebuild(const StepParts&) {}
  /// Between migration and after_migration(): an owned body that is about to be taken out, and one that has just joined, by its row.
  virtual void body_leaves(const RunState&, std::size_t /*row*/) {}
  virtual void body_joins(const RunState&, std::size_t /*row*/) {}
  /// What is thrown is kept as in drift().
  virtual void before_forces(RunState&) {}
  /// Is shown the contacts of the step; null: none.
  virtual PairObserver* observer() { return nullptr; }
  /// The forces of contacts and gravity are summed: adds its own.
  virtual void add_forces(RunState&) {}
  /// Bodies have all their forces.
  virtual void before_kick(const StepParts&) {}
  /// Bodies have their velocities at the end of the step. What is thrown is kept as in drift().
  virtual void after_kick(RunState&) {}
  /// What was dissipated in the step is counted.
  virtual void end_step(const StepParts&) {}
  /// The step has changed at the end of one: its forces count for `difference` [s] more than they were counted in end_step().
  virtual void on_step_change(RunState&, double /*difference*/) {}
  /// What it adds to the force on an owned body that is asleep, and to its torque.
  virtual void add_force_at_rest(const RunState&, std::size_t /*row*/, Vec3& /*force*/, Vec3& /*torque*/) const {}
  /// A body, by its row, is about to fall asleep: it has its last velocities.
  virtual void falls_asleep(RunState&, std::size_t /*row*/) {}
  /// After a whole step. Returns whether neighbour lists must be made again.
  virtual bool after_step(const StepParts&) { return false; }

  /// How much further than otherwise ranks must see each other's bodies [m]. Before lists are made again.
  virtual double extra_reach(const RunState&, bool /*is_begin*/) const { return 0; }
  /// What it adds to the critical step: bodies that it links, and their stiffness, sorted by key.
  virtual std::vector<BodyLink> links(const RunState&) const { return {}; }
  virtual void add_stiffness(const RunState&, StabilityBound&) const {}

  /// In a scene whose bodies stay as they are the smallest of these sets the step. After start(). Collective.
  virtual StepBound bound(const RunState&) const { return {}; }

  /// Asked at the times of output: why the run ends there; "": it goes on. Collective.
  virtual std::string ends_run(const RunState&) const { return {}; }

  // 3. What a restart needs.
  /// Of all ranks, on every rank. Collective.
  virtual EffectRecord record(const RunState&) const { return {}; }
  /// Throws InputError for a record of another scene.
  virtual void restore(RunState&, const EffectRecord&) {}
  /// The items that the state hash adds up, on rank 0; the record as one item, if nothing else is said. Collective.
  virtual std::vector<ItemHash> hashes(const RunState&) const;

  // 4. What a run writes, at a full step.
  virtual void add_frame(const RunState&, Frame&) const {}  ///< rank 0 adds what is not of a body
  virtual void add_energies(const RunState&, Energies&) const {}
  virtual void add_log_columns(const RunState&, const Energies&, std::vector<Column>&) const {}
  virtual std::vector<PlanLine> plan(const RunState&) const { return {}; }

  std::size_t kind() const { return kind_; }  ///< place in the list of kinds
  void set_kind(std::size_t kind) { kind_ = kind; }

 private:
  std::size_t kind_ = 0;
};

/// An effect as the list has it.
struct EffectKind {
  EffectFormat format;
  PlanLine without;  ///< of `--plan` for scenes without it; an empty name: no line
  /// Null where the scene does not need it. Throws UsageError for what cannot be combined with it.
  std::unique_ptr<Effect> (*make)(const RunState&);
  /// The same where no scene needs it, but a program that steps the run, or a checkpoint that has its record. Null: there is none.
  std::unique_ptr<Effect> (*make_on_demand)(const RunState&) = nullptr;
};

}  // namespace scree
