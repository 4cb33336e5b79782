// Damping of fragments that press on something with several pieces at once.
//
// A contact that presses alone is damped for its restitution by chi = 2 zeta / sqrt(2 U / m), U its energy and m the mass that it moves. Of
// n contacts that press together, each with a part of U, each would count that part alone, and the fragment be damped as if zeta were
// sqrt(n) times as large: a cube of 20 cells on its face left at 0.35 of its speed, not at 0.5. All contacts between the same two therefore
// count the energy of all of them and the mobility of the sum of their wrenches.
//
// The sums are those of the last multiple of kReviewSteps, over all ranks, in the order of pairs: the same bits on every rank. A contact
// keeps the result (DampingShare, contact/pair_memory.hpp), so that it migrates, and a restart has it. In its first steps, a small
// part of a contact between stiff fragments, it counts as alone. Laws whose chi does not depend on U need none of it.
#pragma once

#include "solver/state/run_state.hpp"

namespace scree {

/// After the forces of a step. In those that are no multiple of kReviewSteps, and in scenes without bonds, it does nothing. Collective.
void share_damping(RunState& s);

}  // namespace scree
