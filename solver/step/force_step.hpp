// Forces of all pairs of a rank, computed while the messages of its neighbours travel.
#pragma once

#include <cstdint>
#include <span>

#include "solver/pairs/forces.hpp"
#include "solver/ranks/decomposition.hpp"
#include "solver/ranks/failure.hpp"
#include "solver/state/run_state.hpp"

namespace scree {

class ForceStep {
 public:
  /// Forces and torques on all owned bodies, and the state of all pairs after friction_dt. What a pair throws is kept in `failure`;
  /// after a failure nothing is computed, and the messages go on until all ranks know.
  /// in   refresh   ghosts are brought to the present first
  void compute(RunState& s, Decomposition& decomposition, FirstFailure& failure, double friction_dt, bool refresh);

  /// The pairs of a step in which all go in blocks, or are among `due`: see evaluate_blocks(). Bodies do not get their forces.
  void compute_balls(RunState& s, Balance& balance, FirstFailure& failure, const std::vector<std::int32_t>& due,
                     const std::function<void()>& write_columns);

  /// Forces of contacts that begin in this step, with springs at rest; the bodies do not get them.
  void compute_new_contacts(RunState& s, FirstFailure& failure, std::span<const std::int32_t> which);

  /// Contacts that this rank counts, at the present state, with forces that are the same on any number of ranks; changes no state.
  /// Collective.
  FrameContacts contacts(RunState& s, Halo& halo);

  ForceScratch& scratch() { return scratch_; }

 private:
  template <class Evaluate>
  void compute_timed(RunState& s, Balance& balance, FirstFailure& failure, Phase phase, Evaluate&& evaluate);
  void compute_pairs(RunState& s, Balance& balance, FirstFailure& failure, PairClass of, std::span<const std::int32_t> which,
                     double friction_dt);

  ForceScratch scratch_;
  std::vector<PairObserver*> observers_;  // of the effects, in this step
};

}  // namespace scree
