// Bodies of a scene that come from a run: their exact places, and what their pairs remember. Forces are computed again, since materials,
// margins and walls may be others than in that run; the springs of a contact then follow its law, which takes from them and never adds
// (pair_friction.hpp).
#pragma once

#include <vector>

#include "core/storage/start_state.hpp"
#include "solver/bodies/particle_set.hpp"
#include "solver/contact/pair_state.hpp"
#include "solver/state/run_state.hpp"

namespace scree {

/// The record of body b of a scene at the start, with the digits that the table of bodies cannot hold where it comes from a run.
ParticleRecord starting_record(const SolverScene& scene, const StartState& start, std::size_t body);

/// The state of the pairs of a rank's own bodies, in ascending order.
/// Throws InputError for a kind of state, a body or a wall that is not known here.
std::vector<WaitingState> starting_pairs(const SolverScene& scene, const StartState& start, const std::vector<ParticleRecord>& mine);

/// Books what springs hold at the start as taken from the motion before it, as friction takes what it stores: else a spring that unloads
/// would be energy from nowhere. After the first forces.
void count_starting_springs(RunState& s);

}  // namespace scree
