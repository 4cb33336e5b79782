// Bodies at rest that are not computed until something disturbs them (time.sleep of the case).
//
// Falling asleep. Every kSleepSteps steps, counted from t = 0, each body is looked at: it is at rest where its kinetic energy is below
// kSleepEnergy of what it would gain by a fall of its own diameter, and its force and torque below `sleep_tolerance` of its weight. A body
// found so for as long as such a fall takes, its torque not grown, is ready. It falls asleep once all that touch it are ready or asleep:
// velocities become 0, and the kinetic energy is booked. Springs stay. A wall that moves, carries along, answers to force or has a load
// map lets no body sleep that touches it.
//
// Asleep. A pair of which neither side moves is neither examined nor computed: it keeps the result that evaluate_at_rest() gave, which is a
// function of places and springs alone. Each of its contacts notes the force that it had (KeptForce): it is what a later force is compared
// with, however often a partner wakes and falls asleep again, so that small changes cannot add up unseen.
//
// Waking up, in the very step in which
//   - a contact begins with a body that is awake or with a wall that moves: such a contact has no kept force
//   - a contact, or all together, ended ones too, depart by more than `sleep_tolerance` of the weight, or of weight times radius as torque
//   - a wall in contact begins to move
//   - a body in contact is taken out of the run
// What wakes takes the forces of all its contacts, and moves in the next step; those that lie behind it wake by the second of these rules.
//
// All of it follows from the state between two steps (columns `rest`, kept forces), never from lists, ranks or threads. Both owners of a
// pair keep its row alike: it is made as the first of its bodies falls asleep, and goes in the step after the last of them woke, or in the
// step in which the contact ends.
//
// Source: the idea of bodies that sleep, E. Catto, "Simulation islands", Box2D (2023). Departures: a body that touches a sleeper may be
// awake, and forces are tested in place of touch alone: in a heap that is pressed from one side forces change long before anything has
// moved by as much as can be seen, and a stone that rocks forever in its hole would keep a whole heap awake (docs/develop/decisions/030).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "solver/bodies/fluid.hpp"
#include "solver/neighbours/pair_list.hpp"
#include "solver/pairs/forces.hpp"
#include "solver/ranks/exact_sum.hpp"
#include "solver/ranks/failure.hpp"
#include "solver/ranks/halo.hpp"
#include "solver/state/effect.hpp"

namespace scree {

struct RunState;

/// Bodies are looked at in these steps. Fewer looks cost less; a look takes less than a body's share of one step.
inline constexpr std::int64_t kSleepSteps = 64;
/// Kinetic energy at rest, over that of a fall by the own diameter: 1e-4 of its speed. A heap that is damped goes far below it; one that
/// creeps is kept awake by the force, and by the time for which both must hold.
inline constexpr double kSleepEnergy = 1e-8;

/// Weight of a body [N], less that of the fluid that it displaces. 0 of a body that nothing pulls: it never sleeps.
double weight_of(const RunState& s, std::size_t body);

/// The effect. Which pairs are due is asked by the force stage of a step, beside the hooks of all effects.
class Sleep : public Effect {
 public:
  /// The three lists of PairList.
  enum Which : std::size_t { kInner, kOuter, kDuplicated, kLists };

  void on_rebuild(const StepParts& parts) override;
  /// In a step in which that is due: puts to sleep the bodies that are ready. Collective.
  bool after_step(const StepParts& parts) override;
  EffectRecord record(const RunState& s) const override;
  void restore(RunState& s, const EffectRecord& record) override;
  std::vector<ItemHash> hashes(const RunState&) const override { return {}; }  // `rest` of bodies and kept forces say it
  void add_energies(const RunState& s, Energies& energies) const override;
  void add_log_columns(const RunState& s, const Energies& energies, std::vector<Column>& columns) const override;

  /// Before the forces of a step, and once more when ghosts are those of the step: sorts pairs by which bodies sleep, where that has
  /// changed.
  void sort_pairs(RunState& s, ForceScratch& scratch, FirstFailure& failure);
  void update_ghosts(RunState& s, ForceScratch& scratch, FirstFailure& failure);
  /// Pairs of a list that are to be computed.
  std::span<const std::int32_t> due(Which which, const std::vector<std::int32_t>& all) const {
    return any_ ? std::span(due_[which]) : std::span(all);
  }
  /// Once all pairs are computed, before their forces are summed: wakes the bodies that are disturbed.
  void wake_disturbed(RunState& s);

  /// Wakes owned rows: before the pairs of a step are sorted, or between two steps.
  void wake_rows(RunState& s, const std::vector<std::size_t>& rows);

  /// Bodies asleep that touch one of those that leave, of all ranks. Before bodies migrate and are taken out. Collective.
  /// in   leaves   for each owned row
  std::vector<std::int64_t> touching_those_that_leave(const RunState& s, const std::vector<std::uint8_t>& leaves) const;
  /// Wakes those of them that are here. After bodies migrated, before ghosts are made.
  static void wake(RunState& s, const std::vector<std::int64_t>& ids);

 private:
  enum class Kind : std::uint8_t { unknown, awake, border, resting };

  void review(RunState& s, Halo& halo, ForceScratch& scratch, FirstFailure& failure);
  bool find_restless_walls(const RunState& s);
  Kind kind_of_pair(const RunState& s, std::size_t k) const;
  void find_awake_rows(RunState& s);
  void compute_resting(RunState& s, ForceScratch& scratch, FirstFailure& failure);
  bool count_quiet(RunState& s) const;
  void stay_with_neighbours(RunState& s) const;
  bool fall_asleep(RunState& s);

  bool any_ = false, dirty_ = false;                   // somebody sleeps, owned or ghost; pairs are to be sorted
  std::vector<Kind> kind_;                             // of each pair
  std::array<std::vector<std::int32_t>, kLists> due_;  // where somebody sleeps: pairs that are not resting
  std::vector<std::int32_t> border_;                   // one side asleep, the other not at rest
  std::vector<std::int32_t> fresh_;                    // resting, and their results not known
  std::vector<std::uint8_t> restless_;                 // of each wall
  std::vector<std::uint8_t> ghost_sleeps_;
  ExactSum slept_;  // kinetic energy of bodies of this rank as they fell asleep [J]
};

EffectKind sleep_effect();

}  // namespace scree
