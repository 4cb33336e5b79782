// What a step does with the bonds of a scene: their forces, which of them break, and that all ranks hear of it.
#pragma once

#include <cstdint>
#include <vector>

#include "solver/laws/bond.hpp"
#include "solver/step/force_step.hpp"
#include "solver/step/run_state.hpp"
#include "solver/step_size/critical_step.hpp"

namespace scree {

/// Adds the forces of bonds, and those that the case gives, to the bodies. Called when contacts are summed up.
void add_bonds(RunState& s);
void add_given_forces(RunState& s);

/// Bonds that broke in this step, with the contacts that take their place.
///
/// Decided at the positions of the end of the step, for all bonds at once. The forces of bonds that break still make the second half kick
/// of this step; in the first of the next one, the contacts act in their place: the motion changes from one Hamiltonian to another between
/// two steps, at one place, and the difference of their energies is what the totals book as fracture.
class Breakage {
 public:
  /// Before the bodies are kicked: which break, and the forces of the contacts that begin.
  void decide(RunState& s, ForceStep& forces, FirstFailure& failure);
  /// After it: these forces in place of those.
  void replace_forces(RunState& s);

 private:
  std::vector<std::int32_t> shift_loaded(RunState& s) const;

  std::vector<std::size_t> broken_;     // listed bonds
  std::vector<std::int32_t> touching_;  // pairs
};

/// How much further than otherwise ranks must see each other's bodies [m]. Collective.
double extra_reach(const RunState& s, bool is_begin);
/// Tells all ranks which bonds broke since lists were made; those of bodies that left break too. Before ghosts are made. Collective.
/// in   left   whether bodies left since
void share_broken(RunState& s, bool left);
/// Every kReviewSteps steps: all ranks hear which bonds broke before, and find the fragments that are left. Collective.
void review_fragments(RunState& s);
/// The same fragments as a run begins, from the bonds that broke until then.
void begin_fragments(RunState& s);
/// After lists were rebuilt.
void list_bonds(RunState& s, FirstFailure& failure);

/// The step in which each bond broke, known on every rank. Collective.
std::vector<std::int64_t> all_broken_at(const RunState& s);

/// A bond as the critical step takes it.
PairStiffness linearise(const BondList& bonds, const ListedBond& bond, const ParticleSet& p);

/// Longest stable step of the bonds of a scene as it starts, all holding [s], and whose it is; infinite without bonds.
CriticalStep critical_step_of_bonds(const SolverScene& scene);

}  // namespace scree
